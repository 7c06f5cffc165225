#include "haptics/guard.h"

#include <algorithm>
#include <cmath>

namespace intaglio::haptics {

namespace {

constexpr double min_ramp_in = 0.5;  // s
// A late tick may not make up its whole delay in one step of the force.
constexpr double longest_slew = 0.005;  // s

// v, shortened to `limit` if it is longer. Scaled by its largest component first: the norm of a huge finite
// vector may overflow.
Vec3 clamped_length(Vec3 v, double limit) {
  const double largest = v.cwiseAbs().maxCoeff();
  if (largest > limit) v *= limit / largest;
  const double size = v.norm();
  return size > limit ? Vec3(v * (limit / size)) : v;
}

}  // namespace

Guard::Guard(const GuardLimits& limits)
    : limits_(limits),
      force_{limits.peak_force, limits.continuous_force, limits.slew_rate},
      torque_{limits.peak_torque, limits.continuous_torque, limits.torque_slew_rate} {
  limits_.ramp_in = std::max(limits.ramp_in, min_ramp_in);
}

std::uint32_t Guard::fault_of(const GuardInput& input, double dt) const {
  using namespace guard_status;
  if (!input.wanted.is_finite() || !input.tip.allFinite() || !std::isfinite(input.time)) return not_a_number;
  std::uint32_t faults = 0;
  // Negated so that a heartbeat that is not a number, or in the future, counts as late.
  if (!(std::abs(input.time - input.scene_time) <= limits_.scene_timeout)) faults |= scene_stalled;
  if (!(std::abs(input.time - input.link_time) <= limits_.link_timeout)) faults |= link_lost;
  if (started_ && !(dt > 0 && dt <= limits_.loop_timeout)) faults |= loop_stalled;
  if (started_ && (input.tip - last_tip_).cwiseAbs().maxCoeff() > limits_.jump_limit) faults |= jumped;
  return faults;
}

GuardedForce Guard::zero_force() {
  force_.last.setZero();
  torque_.last.setZero();
  return GuardedForce(Wrench{});
}

void Guard::watch_speed(double speed, double dt) {
  if (speed > limits_.velocity_limit) {
    status_ |= guard_status::hand_too_fast;
    enabled_for_ = 0;
  } else {
    enabled_for_ += dt;
  }
}

void Guard::heat_up(Channel& channel, double dt) const {
  if (!(channel.continuous > 0)) return;
  const double load = channel.last.squaredNorm() / (channel.continuous * channel.continuous);
  channel.heat += (load - channel.heat) * std::min(1.0, dt / limits_.thermal_time);
}

void Guard::limit(Channel& channel, const Vec3& wanted, double dt) {
  if (!(channel.peak > 0)) return;  // a device without torque
  // The allowed force falls from the peak (cold motors) to the continuous limit (heat = 1).
  const double peak2 = channel.peak * channel.peak;
  const double continuous2 = std::min(channel.continuous * channel.continuous, peak2);
  const double allowed =
      std::sqrt(continuous2 + (peak2 - continuous2) * std::clamp(1 - channel.heat, 0.0, 1.0));
  const Vec3 target = clamped_length(wanted, allowed);
  if (target != wanted) {
    status_ |= guard_status::clamped;
    if (allowed < 0.999 * channel.peak) status_ |= guard_status::thermally_limited;
  }
  const Vec3 change = target - channel.last;
  const Vec3 step = clamped_length(change, channel.slew_rate * std::min(dt, longest_slew));
  if (step != change) status_ |= guard_status::slewed;
  channel.last = step != change ? clamped_length(channel.last + step, channel.peak) : target;
}

GuardedForce Guard::pass(const GuardInput& input) {
  const double dt = started_ ? input.time - last_time_ : 0;
  const std::uint32_t faults = fault_of(input, dt);
  if ((status_ & guard_status::fault) != 0 || faults != 0) {
    if ((status_ & guard_status::fault) == 0) status_ = guard_status::fault | faults;
    return zero_force();
  }
  status_ = 0;
  heat_up(force_, dt);
  heat_up(torque_, dt);
  const double speed = dt > 0 ? (input.tip - last_tip_).norm() / dt : 0;
  watch_speed(speed, dt);
  last_time_ = input.time;
  last_tip_ = input.tip;
  started_ = true;
  const double ramp = std::min(1.0, enabled_for_ / limits_.ramp_in);
  if (ramp < 1) status_ |= guard_status::ramping;
  limit(force_, ramp * input.wanted.force, dt);
  limit(torque_, ramp * input.wanted.torque, dt);
  return GuardedForce({force_.last, torque_.last});
}

GuardedForce Guard::pass(const Vec3& wanted, double dt) {
  GuardInput input;
  input.wanted.force = wanted;
  input.tip = last_tip_;
  input.time = input.scene_time = input.link_time = last_time_ + dt;
  if (!started_ && dt > 0) {
    started_ = true;
    enabled_for_ = -dt;  // the first tick is at the foot of the ramp
  }
  return pass(input);
}

GuardedForce Guard::release() {
  enabled_for_ = 0;
  started_ = false;
  return zero_force();
}

void Guard::rearm() {
  status_ = 0;
  release();
}

}  // namespace intaglio::haptics
