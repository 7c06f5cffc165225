// Passivity: ensures that the hand never receives more energy than it put in, and says what a device can
// display without generating energy.
//
// The time-domain passivity controller. Between two ticks the device holds a force while the hand moves, so
// that the work is exactly force times displacement. The hand's work, less the energy that contact still
// stores (Proxy's W), is the surplus: the energy dissipated by friction and damping. A sampled spring makes
// it negative, by 1/2 K dx^2 per tick, and so do methods without a potential. The controller then adds
// damping. A damper alpha dissipates alpha v^2 T in a tick of T seconds; with v = dx / T, the deficit is made
// up by
//
//     alpha = deficit T / dx^2,
//
// bounded by `max_damping`, beyond which the damper itself is unstable. The surplus is capped, so that past
// dissipation cannot fund later energy, and so is the deficit, so that what could not be dissipated in time
// is not pursued indefinitely.
//
// Sources: Hannaford and Ryu, "Time-domain passivity control of haptic interfaces", 2002; reference energy
// after Ryu, Preusche, Hannaford and Hirzinger 2005. Real-time; one thread.
#pragma once

#include <optional>
#include <string>

#include "intaglio/material.h"
#include "intaglio/vec.h"

namespace intaglio::haptics {

struct PassivityOptions {
  double max_damping = 1;     // N s/m, of the controller
  double surplus_cap = 1e-4;  // J
  double deficit_cap = 2e-3;  // J
};

class PassivityController {
 public:
  explicit PassivityController(const PassivityOptions& options) : options_(options) {}

  // The hand has moved by `displacement` under the force last sent; contact now stores `stored` joules.
  void observe(const Vec3& displacement, double stored);
  // The force to add in the next tick of `dt` seconds, in which the hand is expected to move as in the last
  // one.
  Vec3 damping_force(const Vec3& displacement, double dt) const;
  // The force that the hand really gets until the next observe().
  void set_sent(const Vec3& force) { sent_ = force; }
  // Forgets surplus and deficit; contact now stores `stored` joules.
  void reset(double stored = 0) {
    surplus_ = 0;
    stored_ = stored;
  }

  double surplus() const { return surplus_; }             // J; negative: contact has generated energy
  double work_on_hand() const { return -work_by_hand_; }  // J, since construction

 private:
  PassivityOptions options_;
  Vec3 sent_ = Vec3::Zero();
  double surplus_ = 0, stored_ = 0, work_by_hand_ = 0;
};

// The stiffness and damping that a device can display passively.
//
// Pure functions of the device's damping b (N s/m), the servo period T (s) and its encoders' resolution (m).
// A sampled spring of stiffness K with virtual damping B is passive when b > K T / 2 + |B| (Colgate and
// Schenkel 1994). A hand adds damping of its own, 2 to 10 N s/m, which is not counted: the limit is
// sufficient, not necessary. Quantised encoders inject more energy than friction dissipates unless the
// friction of the device is at least K resolution / 2 (Diolaiti, Niemeyer, Barbagli and Salisbury 2006).

struct DeviceDynamics {
  double damping = 0.3;        // N s/m, b, of the device without a hand
  double friction = 0.02;      // N, Coulomb
  double resolution = 2.3e-5;  // m
  double rate = 1000;          // Hz
};

// The stiffest spring that is passive with virtual damping B, N/m: 2 (b - B) / T, never negative.
double stiffness_limit(const DeviceDynamics& device, double damping = 0);
// The stiffest spring whose quantisation the device's friction absorbs, N/m: 2 friction / resolution.
double quantisation_limit(const DeviceDynamics& device);
// One line when K and B exceed these limits, so that the passivity controller has work to do; absent
// otherwise.
std::optional<std::string> stability_warning(const DeviceDynamics& device, double stiffness, double damping);

// The stiffness of a material felt through a tip, limited by the device. Pure; N/m.
//
// A tip of radius a pressed into a half space of E* = E / (1 - nu^2) is a spring of 2 a E* (flat punch,
// Sneddon 1965), in series with the stiffest spring that is displayed. Stone, glass and wood are a thousand
// times stiffer than any device and feel alike; foam and rubber do not.
inline double felt_stiffness(const Material& material, double tip_radius, double displayed) {
  if (!(tip_radius > 0)) return displayed;  // no tip: no indentation
  const double punch =
      2 * tip_radius * material.youngs_modulus / (1 - material.poisson_ratio * material.poisson_ratio);
  return displayed * punch / (displayed + punch);
}

}  // namespace intaglio::haptics
