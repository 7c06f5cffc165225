// An audio device that plays to nobody, in real time: for machines without a sound card, and for measuring.
//
// A thread renders a buffer each buffer's time, by the steady clock. A buffer that is begun more than its own
// time late counts as an underrun; the clock goes on from there.
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "intaglio/sound/outputs/audio_device.h"
#include "intaglio/sound/outputs/render_meter.h"

namespace intaglio::sound {

class NullDevice : public AudioDevice {
 public:
  explicit NullDevice(int sample_rate = 44'100, int buffer_frames = 256);
  ~NullDevice() override { stop(); }

  std::string name() const override { return "null"; }
  int sample_rate() const override { return sample_rate_; }
  int buffer_frames() const override { return buffer_frames_; }
  Result<void> start(AudioSource& source) override;
  void stop() override;
  AudioStatus status() const override { return meter_.status(double(buffer_frames_) / sample_rate_); }

 private:
  void play(AudioSource& source);

  int sample_rate_, buffer_frames_;
  std::vector<float> buffer_;
  RenderMeter meter_;
  std::mutex mutex_;  // of is_stopping_; not held while rendering
  std::condition_variable wake_;
  bool is_stopping_ = false;
  std::thread thread_;
};

}  // namespace intaglio::sound
