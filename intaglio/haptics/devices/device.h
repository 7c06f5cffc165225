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
  // The force on the hand until the next write.
  virtual void write(const GuardedForce& force) = 0;
};

}  // namespace intaglio::haptics
