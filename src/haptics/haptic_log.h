// A session of touch as a file: every tick's pose, contact and force, and which texture it was felt on.
//
// Text, CSV: four lines of header (format, rate, texture, fingerprint of the surface), the names of the
// columns with their units, a row a tick, and a last line with the number of rows and a hash of all before
// it, so that a file that was cut or changed is told from a whole one. Numbers are the shortest that read
// back exactly: a replay (devices/replay.h) gives the same forces to the bit. Not real-time; 400 bytes a
// tick.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "haptics/device.h"
#include "haptics/servo.h"
#include "intaglio/error.h"

namespace intaglio::haptics {

struct HapticLog {
  double rate = 1000;                // Hz
  std::string texture;               // its name, one line
  std::uint64_t surface = 0;         // fingerprint of what was felt
  std::vector<ServoSample> samples;  // one a tick, the first at time 0
};

// Of what a tip can feel of a surface: depths, sizes, edge; not where it lies.
std::uint64_t fingerprint(const surface::Surface& surface);

std::string encode_log(double rate, std::string_view texture, std::uint64_t surface,
                       std::span<const ServoSample> samples);
// Errors name the line. `name` stands for the file.
Result<HapticLog> decode_log(std::string_view text, const std::string& name);

// A device that moves as one did before: the poses of a recording (haptic_log.h), one a read.
//
// Forces written to it are compared with those that were recorded. Real-time. At the end it stays where it
// is.

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
