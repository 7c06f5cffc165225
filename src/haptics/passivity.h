// Time-domain passivity: watches that the hand never gets more energy than it gave, and damps when it would.
//
// Between two ticks the device holds a force while the hand moves, so that the work is exactly force times
// displacement. What the hand has put in, less what contact still stores (Proxy's W), is the surplus: energy
// that friction and damping took away. A sampled spring makes it negative, 1/2 K dx^2 a tick, and so do
// methods without a potential. The controller then adds a damping force, alpha = deficit / (T v^2), bounded
// by what is itself stable. The surplus is capped, so that old friction does not license new energy, and so
// is the deficit, so that what could not be dissipated is not chased for ever.
//
// Sources: Hannaford and Ryu, "Time-domain passivity control of haptic interfaces", 2002; reference energy
// after Ryu, Preusche, Hannaford and Hirzinger 2005. Real-time; one thread.
#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "intaglio/material.h"
#include "intaglio/vec.h"

namespace intaglio::haptics {

struct PassivityOptions {
  double most_damping = 1;    // N s/m, of the controller
  double surplus_cap = 1e-4;  // J
  double deficit_cap = 2e-3;  // J
};

class PassivityController {
 public:
  explicit PassivityController(const PassivityOptions& options) : options_(options) {}

  // The hand moved by `displacement` under the force last sent; contact now stores `stored` joules.
  void observe(const Vec3& displacement, double stored) {
    const double put_in = -sent_.dot(displacement);
    surplus_ += put_in - (stored - stored_);
    stored_ = stored;
    given_ += put_in;
    surplus_ = std::clamp(surplus_, -options_.deficit_cap, options_.surplus_cap);
  }
  // What to add to the force for the next tick of `dt` seconds, in which the hand is expected to move as it
  // did.
  Vec3 damp(const Vec3& displacement, double dt) {
    const double square = displacement.squaredNorm();
    if (surplus_ >= 0 || !(square > 0)) return Vec3::Zero();
    const double alpha = std::min(-surplus_ * dt / square, options_.most_damping);
    return -alpha / dt * displacement;
  }
  // What really goes to the hand until the next observe().
  void sent(const Vec3& force) { sent_ = force; }
  // Forgets the past; contact stores `stored` now.
  void reset(double stored = 0) {
    surplus_ = 0;
    stored_ = stored;
  }

  double surplus() const { return surplus_; }      // J, negative: contact has made energy
  double work_on_hand() const { return -given_; }  // J, since construction

 private:
  PassivityOptions options_;
  Vec3 sent_ = Vec3::Zero();
  double surplus_ = 0, stored_ = 0, given_ = 0;
};

// What a device can display without making energy: limits of stiffness and damping, and of detail.
//
// Pure functions of the device's damping b (N s/m), the servo period T (s) and its encoders' resolution (m).
// A held spring of stiffness K with virtual damping B is passive when b > K T / 2 + |B| (Colgate and Schenkel
// 1994). A hand adds its own damping, 2 to 10 N s/m, which the limit does not count: it is sufficient, not
// necessary. Quantised encoders do more than friction can take away unless the friction of the device is at
// least K resolution / 2 (Diolaiti, Niemeyer, Barbagli and Salisbury 2006), and differentiate into a velocity
// noise of resolution / T, which B turns into force noise.

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

// How stiff a surface of some material feels under a tip, as far as the device can show it.
//
// A tip of radius a pressed into a half space of E* = E / (1 - nu^2) is a spring of 2 a E* (flat punch,
// Sneddon 1965), in series with the stiffest spring that is displayed. Stone, glass and wood are a thousand
// times stiffer than any device and feel alike; foam and rubber do not. Pure; N/m.

inline double punch_stiffness(const Material& material, double tip_radius) {
  return 2 * tip_radius * material.youngs_modulus / (1 - material.poisson_ratio * material.poisson_ratio);
}

inline double felt_stiffness(const Material& material, double tip_radius, double displayed) {
  if (!(tip_radius > 0)) return displayed;  // no tip, no indentation to speak of
  const double punch = punch_stiffness(material, tip_radius);
  return displayed * punch / (displayed + punch);
}

}  // namespace intaglio::haptics
