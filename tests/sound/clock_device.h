// An audio device whose clock the caller advances: it renders on request, on the caller's thread, and records
// its input. For tests, and for offline mixes through the live path.
#pragma once

#include <algorithm>
#include <vector>

#include "sound/audio_device.h"

namespace intaglio::sound {

class TestClockDevice : public AudioDevice {
 public:
  explicit TestClockDevice(int sample_rate = 44'100, int buffer_frames = 256)
      : sample_rate_(sample_rate), buffer_frames_(buffer_frames) {}

  std::string name() const override { return "test clock"; }
  int sample_rate() const override { return sample_rate_; }
  int buffer_frames() const override { return buffer_frames_; }
  Result<void> start(AudioSource& source) override {
    if (source_) return fail("test clock audio device", "is playing already");
    source_ = &source;
    return {};
  }
  void stop() override { source_ = nullptr; }
  AudioStatus status() const override { return meter_.status(0); }

  // Pulls `frames` more, a buffer at a time. Nothing happens while stopped.
  void turn(int frames) {
    while (source_ && frames > 0) {
      const int now = std::min(frames, buffer_frames_);
      const std::size_t done = played_.size();
      played_.resize(done + 2 * std::size_t(now));
      meter_.render(*source_, std::span(played_).subspan(done), sample_rate_);
      frames -= now;
    }
  }
  // Everything so far, interleaved.
  const std::vector<float>& played() const { return played_; }
  double time() const { return double(played_.size() / 2) / sample_rate_; }

 private:
  int sample_rate_, buffer_frames_;
  AudioSource* source_ = nullptr;
  RenderMeter meter_;
  std::vector<float> played_;
};

}  // namespace intaglio::sound
