// A recorded haptic session: the pose, contact and force of every tick, and the texture on which they were
// felt.
//
// CSV: four header lines (format, rate, texture, fingerprint of the surface), the column names with their
// units, one row per tick, and a last line with the number of rows and a hash of everything before it, so
// that truncated or edited files are detected. Numbers are the shortest that read back exactly, so that a
// ReplayDevice reproduces the forces to the bit. Not real-time; 400 bytes per tick.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/hash.h"
#include "haptics/device.h"
#include "haptics/servo.h"
#include "intaglio/error.h"

namespace intaglio::haptics {

struct HapticLog {
  double rate = 1000;                // Hz
  std::string texture;               // name, one line
  std::uint64_t surface = 0;         // fingerprint()
  std::vector<ServoSample> samples;  // one per tick, the first at time 0
};

// Hash of everything about a surface that a tip can feel: depths, sizes, edge mode; not its pose.
std::uint64_t fingerprint(const surface::Surface& surface);

// Encodes a log tick by tick: its text, in parts, goes to `out`. The head at construction, then a row a tick,
// then the last line by finish().
class LogEncoder {
 public:
  LogEncoder(double rate, std::string_view texture, std::uint64_t surface,
             std::function<void(std::string_view)> out);

  void add(const ServoSample& sample);
  void finish();

 private:
  void emit();

  double rate_;
  std::function<void(std::string_view)> out_;
  std::string text_;  // the piece being encoded
  Hash hash_;
  std::size_t rows_ = 0;
};

std::string encode_log(double rate, std::string_view texture, std::uint64_t surface,
                       std::span<const ServoSample> samples);
// Errors name the line; `name` is the file's name for them.
Result<HapticLog> decode_log(std::string_view text, const std::string& name);

// Replays the poses of a recording, one per read, and compares the forces written to it with the recorded
// ones. Stays at the last pose at the end. Real-time.
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
  // Largest difference between a force written and the one recorded in that tick, N.
  double largest_difference() const { return largest_difference_; }

 private:
  // Devices without orientation are recorded as upright.
  static bool upright(const Quat& q) { return q.coeffs() == Quat::Identity().coeffs(); }

  std::span<const ServoSample> samples_;
  const ServoSample* now_ = nullptr;
  std::size_t next_ = 0;
  double largest_difference_ = 0;
};

}  // namespace intaglio::haptics
