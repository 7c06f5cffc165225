// What a haptic device is to the servo loop: a position to read, a guarded force to write.
#pragma once

#include "intaglio/core/vec.h"
#include "intaglio/haptics/guard.h"

namespace intaglio::haptics {

class Device {
 public:
  virtual ~Device() = default;

  // Position of the tip in the device's own workspace, metres, as its encoders report it.
  virtual Vec3 read() = 0;
  // The force (and torque, where displays_torque()) on the hand until the next write.
  virtual void write(const GuardedForce& force) = 0;

  // Turns the pen from upright (shaft along +Y) to how the grip is held. Asked only of devices that know.
  virtual bool reads_orientation() const { return false; }
  virtual Quat orientation() { return Quat::Identity(); }
  // 6-DOF devices display torque about the grip; to the others it is not sent.
  virtual bool displays_torque() const { return false; }
  // Seconds since the device was last heard of; 0 where it answers every read.
  virtual double silent_for() const { return 0; }
};

}  // namespace intaglio::haptics
