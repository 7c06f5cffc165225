#include "intaglio/haptics/guard.h"

#include <algorithm>

namespace intaglio::haptics {

GuardedForce Guard::pass(const Vec3& wanted, double dt) {
  const bool faulty = (status_ & guard_status::fault) != 0 || !wanted.allFinite() || !(dt > 0);
  if (faulty) {
    status_ = guard_status::fault;
    last_.setZero();
    return GuardedForce(last_);
  }
  status_ = 0;
  Vec3 force = wanted;
  if (enabled_for_ < limits_.ramp_in) {
    force *= enabled_for_ / limits_.ramp_in;
    status_ |= guard_status::ramping;
  }
  enabled_for_ += dt;
  // The largest component first: the norm of a huge finite vector may overflow.
  const double largest = force.cwiseAbs().maxCoeff();
  if (largest > limits_.peak_force) force *= limits_.peak_force / largest;
  if (const double size = force.norm(); size > limits_.peak_force || largest > limits_.peak_force) {
    force *= std::min(1.0, limits_.peak_force / size);
    status_ |= guard_status::clamped;
  }
  const Vec3 change = force - last_;
  const double most = limits_.slew_rate * dt;
  if (const double size = change.norm(); size > most) {
    force = last_ + change * (most / size);
    status_ |= guard_status::slewed;
  }
  last_ = force;
  return GuardedForce(force);
}

void Guard::rearm() {
  status_ = 0;
  enabled_for_ = 0;
  last_.setZero();
}

}  // namespace intaglio::haptics
