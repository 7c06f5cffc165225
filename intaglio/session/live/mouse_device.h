// A haptic device that a mouse leads: a PHANToM Desktop in a simulated hand whose wish is where the mouse
// points. The force that a hand would feel holds this one back, so that the pen stays on the relief.
//
// lead() from one thread, read() and write() from the servo thread; neither waits. Real-time.
#pragma once

#include "intaglio/core/latest.h"
#include "intaglio/haptics/devices/simulated.h"

namespace intaglio::session {

class MouseDevice : public haptics::Device {
 public:
  // `start` in the device's workspace, metres.
  MouseDevice(const haptics::DeviceModel& model, const haptics::Hand& hand, const Vec3& start);

  // Where the hand wants the tip from now on, device workspace. It goes there at `speed` m/s at most.
  void lead(const Vec3& target) { target_.publish(target); }

  Vec3 read() override;
  void write(const haptics::GuardedForce& force) override { force_ = force.newtons(); }

 private:
  static constexpr double speed = 0.6;  // m/s, well below the guard's limit

  haptics::DeviceModel model_;
  haptics::Hand hand_;
  Latest<Vec3> target_;
  // The servo thread's.
  Vec3 wanted_, position_, velocity_ = Vec3::Zero(), force_ = Vec3::Zero();
};

}  // namespace intaglio::session
