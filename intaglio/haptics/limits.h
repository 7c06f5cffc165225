// What a device can display without making energy: limits of stiffness and damping, and of detail.
//
// Pure functions of the device's damping b (N s/m), the servo period T (s) and its encoders' resolution (m).
// A held spring of stiffness K with virtual damping B is passive when b > K T / 2 + |B| (Colgate and Schenkel
// 1994). A hand adds its own damping, 2 to 10 N s/m, which the limit does not count: it is sufficient, not
// necessary. Quantised encoders do more than friction can take away unless the friction of the device is at
// least K resolution / 2 (Diolaiti, Niemeyer, Barbagli and Salisbury 2006), and differentiate into a velocity
// noise of resolution / T, which B turns into force noise.
#pragma once

#include <optional>
#include <string>

namespace intaglio::haptics {

struct DeviceDynamics {
  double damping = 0.3;        // N s/m, b, of the device without a hand
  double friction = 0.02;      // N, Coulomb
  double resolution = 2.3e-5;  // m
  double rate = 1000;          // Hz
};

// The stiffest spring that is passive with virtual damping B, N/m: 2 (b - B) / T, never negative.
double stiffness_limit(const DeviceDynamics& device, double damping = 0);
// The most virtual damping that is passive with stiffness K, N s/m: b - K T / 2, never negative.
double damping_limit(const DeviceDynamics& device, double stiffness);
// The stiffest spring whose quantisation the device's friction absorbs, N/m: 2 friction / resolution.
double quantisation_limit(const DeviceDynamics& device);
// Root mean square force noise of damping B on differentiated encoders, N.
double damping_noise(const DeviceDynamics& device, double damping);
// The finest wavelength that a servo loop can display to a hand moving at `speed` (m/s), metres: four ticks
// of it, half the frequency at which sampling ends. A footprint of that size removes what is finer.
double finest_wavelength(const DeviceDynamics& device, double speed);

// A warning, one line, where K and B are beyond these limits; absent where they are within. The passivity
// controller then has work to do.
std::optional<std::string> stability_warning(const DeviceDynamics& device, double stiffness, double damping);

}  // namespace intaglio::haptics
