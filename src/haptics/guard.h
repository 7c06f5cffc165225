// A force and the torque that it has about a point: what the pen does to the hand.
//
// The torque is about the point that the wrench is named for (the grip), world frame, N and N m. Moving it to
// another point is exact; only differences of points occur, so that the world's origin does not matter.
#pragma once

#include <cstdint>

#include "intaglio/vec.h"

namespace intaglio::haptics {

struct Wrench {
  Vec3 force = Vec3::Zero();   // N
  Vec3 torque = Vec3::Zero();  // N m

  // A force at `at`, felt about `about`.
  static Wrench of(const Vec3& force, const Vec3& at, const Vec3& about) {
    return {force, (at - about).cross(force)};
  }
  // The same wrench about another point: `step` from the old point to the new one.
  Wrench about(const Vec3& step) const { return {force, torque - step.cross(force)}; }

  Wrench& operator+=(const Wrench& other) {
    force += other.force;
    torque += other.torque;
    return *this;
  }
  bool is_finite() const { return force.allFinite() && torque.allFinite(); }
};

// The last step before any haptic device. A device takes a GuardedForce only, and only a Guard can make one,
// so that no code path goes around it.
//
// What it holds: force and torque at most their peak, and in the long run (a running mean of the square, as a
// motor heats) at most their continuous limit; at most `slew_rate` of change; a ramp-in of half a second or
// more after arming; no force while the hand is faster than `velocity_limit`, and a new ramp-in after. These
// latch a fault, at once zero until rearm(): not-a-number; a scene or a device that has not been heard of for
// longer than its timeout; ticks further apart than `loop_timeout`; a tip that jumps. Zero therefore comes
// within timeout + one tick of the cause (21 ms at 1 kHz). A guard that is not called can do nothing: a
// device must itself let go when writes stop, as PHANToM drivers do. Real-time: no allocation, no lock, no
// exception; one Guard a device, one thread. 30 ns.

class GuardedForce {
 public:
  const Vec3& newtons() const { return wrench_.force; }
  // About the grip; zero for devices without a torque limit of their own.
  const Vec3& newton_metres() const { return wrench_.torque; }

 private:
  friend class Guard;
  explicit GuardedForce(const Wrench& wrench) : wrench_(wrench) {}
  Wrench wrench_;
};

struct GuardLimits {
  double peak_force = 7.9;         // N, PHANToM Desktop
  double slew_rate = 2000;         // N/s
  double ramp_in = 0.5;            // s from arming to full force; at least 0.5 whatever is asked for
  double continuous_force = 1.75;  // N, PHANToM Desktop
  double thermal_time = 30;        // s, of the running mean of force squared
  double peak_torque = 0;          // N m; 0: the device displays no torque
  double continuous_torque = 0;    // N m
  double torque_slew_rate = 100;   // N m/s
  double velocity_limit = 1.5;     // m/s, of the device's tip
  double jump_limit = 0.05;        // m between two ticks
  double scene_timeout = 0.020;    // s
  double link_timeout = 0.020;     // s
  double loop_timeout = 0.020;     // s
};

namespace guard_status {
inline constexpr std::uint32_t clamped = 1u << 0;   // larger than the force or torque that is allowed now
inline constexpr std::uint32_t slewed = 1u << 1;    // changed faster than the slew rate
inline constexpr std::uint32_t ramping = 1u << 2;   // within the ramp-in
inline constexpr std::uint32_t fault = 1u << 3;     // latched: zero force until rearm()
inline constexpr std::uint32_t warm = 1u << 4;      // clamped, and below the peak: the continuous limit
inline constexpr std::uint32_t too_fast = 1u << 5;  // the hand is over the velocity limit: force goes to zero
inline constexpr std::uint32_t not_a_number = 1u << 6;  // why it faulted, latched with it
inline constexpr std::uint32_t scene_stalled = 1u << 7;
inline constexpr std::uint32_t link_lost = 1u << 8;
inline constexpr std::uint32_t loop_stalled = 1u << 9;
inline constexpr std::uint32_t jumped = 1u << 10;
}  // namespace guard_status

// What is asked of the guard in one tick. Times on one clock, seconds.
struct GuardInput {
  Wrench wanted;            // torque about the grip
  Vec3 tip = Vec3::Zero();  // m, device frame
  double time = 0;          // now
  double scene_time = 0;    // when the scene was last heard of
  double link_time = 0;     // when the device was last heard of
};

class Guard {
 public:
  explicit Guard(const GuardLimits& limits);

  // The force that may go to the device until the next tick.
  GuardedForce pass(const GuardInput& input);
  // The same for a caller that is its own clock and watches scene, link and speed itself: `dt` seconds after
  // the last pass.
  GuardedForce pass(const Vec3& wanted, double dt);

  // No force, at once, for letting go of the hand; what comes after starts at the foot of the ramp.
  GuardedForce release();

  // Bits of guard_status for the last pass().
  std::uint32_t status() const { return status_; }
  // Running mean of force squared over the square of its limit: never over 1.
  double heat() const { return force_.heat; }
  const GuardLimits& limits() const { return limits_; }
  // Clears a latched fault and starts the ramp-in anew. The heat stays.
  void rearm();

 private:
  // Of force or torque: what was last let through, and how warm that has made the motors.
  struct Channel {
    double peak, continuous, slew_rate;
    Vec3 last = Vec3::Zero();
    double heat = 0;  // of continuous^2
  };

  std::uint32_t fault_of(const GuardInput& input, double dt) const;
  void watch_speed(double speed, double dt);
  void limit(Channel& channel, const Vec3& wanted, double dt);
  void heat_up(Channel& channel, double dt) const;
  GuardedForce nothing();

  GuardLimits limits_;
  Channel force_, torque_;
  Vec3 last_tip_ = Vec3::Zero();
  double last_time_ = 0, enabled_for_ = 0;  // s
  bool started_ = false;
  std::uint32_t status_ = 0;
};

}  // namespace intaglio::haptics
