// The last step before any haptic device. A device takes a GuardedForce only, and only a Guard can make one,
// so that no code path goes around it.
//
// What it holds: at most `peak_force`; at most `slew_rate` of change; a ramp-in after contact is enabled;
// not-a-number becomes zero force and latches a fault until rearm(). Real-time: no allocation, no lock, no
// exception; one Guard a device, one thread.
#pragma once

#include <cstdint>

#include "intaglio/core/vec.h"

namespace intaglio::haptics {

class GuardedForce {
 public:
  const Vec3& newtons() const { return force_; }

 private:
  friend class Guard;
  explicit GuardedForce(const Vec3& force) : force_(force) {}
  Vec3 force_;
};

struct GuardLimits {
  double peak_force = 7.9;  // N, PHANToM Desktop
  double slew_rate = 8000;  // N/s
  double ramp_in = 0.5;     // s from enabling to full force
};

namespace guard_status {
inline constexpr std::uint32_t clamped = 1u << 0;  // larger than the peak force
inline constexpr std::uint32_t slewed = 1u << 1;   // changed faster than the slew rate
inline constexpr std::uint32_t ramping = 1u << 2;  // within the ramp-in
inline constexpr std::uint32_t fault = 1u
                                       << 3;  // latched: not-a-number was asked for; zero force until rearm()
}  // namespace guard_status

class Guard {
 public:
  explicit Guard(const GuardLimits& limits) : limits_(limits) {}

  // The force that may go to the device for the next `dt` seconds.
  GuardedForce pass(const Vec3& wanted, double dt);
  // Bits of guard_status for the last pass().
  std::uint32_t status() const { return status_; }
  // Clears a latched fault and starts the ramp-in anew.
  void rearm();

 private:
  GuardLimits limits_;
  Vec3 last_ = Vec3::Zero();
  double enabled_for_ = 0;  // s
  std::uint32_t status_ = 0;
};

}  // namespace intaglio::haptics
