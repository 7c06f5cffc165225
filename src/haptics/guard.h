// The guard, the last step before any haptic device; and the wrench, what a pen does to a hand.
#pragma once

#include <cstdint>

#include "intaglio/vec.h"

namespace intaglio::haptics {

// A force and its torque about a reference point (the grip), world frame, N and N m. Moving it to another
// reference point is exact, and depends on differences of points only, not on the world's origin.
struct Wrench {
  Vec3 force = Vec3::Zero();   // N
  Vec3 torque = Vec3::Zero();  // N m

  // A force that acts at `at`, with its torque about `about`.
  static Wrench of(const Vec3& force, const Vec3& at, const Vec3& about) {
    return {force, (at - about).cross(force)};
  }
  // The same wrench about another reference point; `step` leads from the old one to it.
  Wrench about(const Vec3& step) const { return {force, torque - step.cross(force)}; }

  Wrench& operator+=(const Wrench& other) {
    force += other.force;
    torque += other.torque;
    return *this;
  }
  bool is_finite() const { return force.allFinite() && torque.allFinite(); }
};

// The guard. A device takes only a GuardedForce, and only a Guard can make one, so no code path can bypass
// it.
//
// Limits: force and torque never exceed their peak, and in the long run (a running mean of the square, as a
// motor heats) their continuous limit; they change by at most `slew_rate`; they ramp in over at least half a
// second after arming; there is no force while the hand is faster than `velocity_limit`, and a new ramp-in
// after that. The following latch a fault (zero force at once, until rearm()): not-a-number; a scene or a
// device that is silent for longer than its timeout; ticks further apart than `loop_timeout`; a tip that
// jumps. The force is therefore zero within the timeout and one tick of the cause (21 ms at 1 kHz). A guard
// cannot act when it is not called: the device must drop the force when writes stop, as PHANToM drivers do.
// Real-time: no allocation, no lock, no exception; one Guard per device, one thread. 30 ns.

class GuardedForce {
 public:
  const Vec3& newtons() const { return wrench_.force; }
  // About the grip; zero unless GuardLimits::peak_torque is set.
  const Vec3& newton_metres() const { return wrench_.torque; }

 private:
  friend class Guard;
  explicit GuardedForce(const Wrench& wrench) : wrench_(wrench) {}
  Wrench wrench_;
};

struct GuardLimits {
  double peak_force = 7.9;         // N, PHANToM Desktop
  double slew_rate = 2000;         // N/s
  double ramp_in = 0.5;            // s from arming to full force; never below 0.5
  double continuous_force = 1.75;  // N, PHANToM Desktop
  double thermal_time = 30;        // s, of the running mean of force squared
  double peak_torque = 0;          // N m; 0: no torque is sent
  double continuous_torque = 0;    // N m
  double torque_slew_rate = 100;   // N m/s
  double velocity_limit = 1.5;     // m/s, of the device's tip
  double jump_limit = 0.05;        // m between two ticks
  double scene_timeout = 0.020;    // s
  double link_timeout = 0.020;     // s
  double loop_timeout = 0.020;     // s
};

namespace guard_status {
inline constexpr std::uint32_t clamped = 1u << 0;            // reduced to the force or torque allowed now
inline constexpr std::uint32_t slewed = 1u << 1;             // held back by the slew rate
inline constexpr std::uint32_t ramping = 1u << 2;            // within the ramp-in
inline constexpr std::uint32_t fault = 1u << 3;              // latched: zero force until rearm()
inline constexpr std::uint32_t thermally_limited = 1u << 4;  // clamped below the peak: the motors are warm
inline constexpr std::uint32_t hand_too_fast = 1u << 5;      // over the velocity limit: force goes to zero
// Reasons for a fault, latched with it.
inline constexpr std::uint32_t not_a_number = 1u << 6;
inline constexpr std::uint32_t scene_stalled = 1u << 7;
inline constexpr std::uint32_t link_lost = 1u << 8;
inline constexpr std::uint32_t loop_stalled = 1u << 9;
inline constexpr std::uint32_t jumped = 1u << 10;
}  // namespace guard_status

// Input of one tick. All times are on one clock, seconds.
struct GuardInput {
  Wrench wanted;            // torque about the grip
  Vec3 tip = Vec3::Zero();  // m, device frame
  double time = 0;          // now
  double scene_time = 0;    // of the scene's last heartbeat
  double link_time = 0;     // of the device's last answer
};

class Guard {
 public:
  explicit Guard(const GuardLimits& limits);

  // The force that the device may display until the next tick.
  GuardedForce pass(const GuardInput& input);
  // The same for a caller without a clock, which checks scene, link and speed itself: `dt` seconds after the
  // last pass.
  GuardedForce pass(const Vec3& wanted, double dt);

  // Zero force at once; the next pass starts a new ramp-in.
  GuardedForce release();

  // Bits of guard_status after the last pass().
  std::uint32_t status() const { return status_; }
  // Running mean of force squared over the square of its limit: never over 1.
  double heat() const { return force_.heat; }
  const GuardLimits& limits() const { return limits_; }
  // Clears a latched fault and restarts the ramp-in. The heat stays.
  void rearm();

 private:
  // Force or torque: its limits, its last output, and the heat of its motors.
  struct Channel {
    double peak, continuous, slew_rate;
    Vec3 last = Vec3::Zero();
    double heat = 0;  // running mean of last^2 / continuous^2
  };

  std::uint32_t fault_of(const GuardInput& input, double dt) const;
  void watch_speed(double speed, double dt);
  void limit(Channel& channel, const Vec3& wanted, double dt);
  void heat_up(Channel& channel, double dt) const;
  GuardedForce zero_force();

  GuardLimits limits_;
  Channel force_, torque_;
  Vec3 last_tip_ = Vec3::Zero();
  double last_time_ = 0, enabled_for_ = 0;  // s
  bool started_ = false;
  std::uint32_t status_ = 0;
};

}  // namespace intaglio::haptics
