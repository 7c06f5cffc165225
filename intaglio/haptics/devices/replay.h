// A device that moves as one did before: the poses of a recording (haptic_log.h), one a read.
//
// Forces written to it are compared with those that were recorded. Real-time. At the end it stays where it
// is.
#pragma once

#include <algorithm>
#include <span>

#include "intaglio/haptics/devices/device.h"
#include "intaglio/haptics/servo.h"

namespace intaglio::haptics {

class ReplayDevice : public Device {
 public:
  // `samples` outlive the device and are not empty.
  explicit ReplayDevice(std::span<const ServoSample> samples) : samples_(samples) {}

  Vec3 read() override {
    now_ = &samples_[std::min(next_++, samples_.size() - 1)];
    return now_->device;
  }
  bool reads_orientation() const override { return now_ != nullptr && !upright(now_->orientation); }
  Quat orientation() override { return now_->orientation; }
  void write(const GuardedForce& force) override {
    if (now_ != nullptr && next_ <= samples_.size())
      largest_difference_ = std::max(largest_difference_, (force.newtons() - now_->force).norm());
  }

  bool at_end() const { return next_ >= samples_.size(); }
  // Between a force written and the one recorded in its tick, N.
  double largest_difference() const { return largest_difference_; }

 private:
  // What a device that tells no orientation leaves in a recording.
  static bool upright(const Quat& q) { return q.coeffs() == Quat::Identity().coeffs(); }

  std::span<const ServoSample> samples_;
  const ServoSample* now_ = nullptr;
  std::size_t next_ = 0;
  double largest_difference_ = 0;
};

}  // namespace intaglio::haptics
