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

#include "intaglio/core/vec.h"

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

}  // namespace intaglio::haptics
