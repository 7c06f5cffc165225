// A device that is not there: it rests at the middle of its workspace and feels nothing.
#pragma once

#include "haptics/device.h"

namespace intaglio::haptics {

class NullDevice : public Device {
 public:
  Vec3 read() override { return Vec3::Zero(); }
  void write(const GuardedForce&) override {}
};

}  // namespace intaglio::haptics
