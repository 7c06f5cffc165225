// Where live sound goes: something that asks for samples when it needs them.
//
// A device pulls: it calls AudioSource::render() from a thread of its own until it is stopped. Samples are
// interleaved left, right, in -1..1. Kinds: a sound card (rtaudio_device.h), one that plays to nobody in real
// time (null_device.h), and one whose clock a test turns (test_clock_device.h); open_device.h chooses.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "intaglio/core/error.h"

namespace intaglio::sound {

class AudioSource {
 public:
  virtual ~AudioSource() = default;
  // Fills `stereo`, of any even length. Called by the device's thread: no allocation, lock, log or exception.
  virtual void render(std::span<float> stereo) noexcept = 0;
};

struct AudioStatus {
  std::uint64_t buffers = 0;    // asked for
  std::uint64_t underruns = 0;  // buffers that came too late, as far as the device can tell
  double latency = 0;           // s, from render() to the speaker: what is buffered below us
  double busiest = 0;           // the longest render(), of a buffer's time
  std::string error;            // why it stopped by itself; usually empty
};

class AudioDevice {
 public:
  // Stops.
  virtual ~AudioDevice() = default;

  virtual std::string name() const = 0;
  virtual int sample_rate() const = 0;    // Hz, as it really is
  virtual int buffer_frames() const = 0;  // of one render(), usually

  // `source` must live until stop(). Starting twice is an error.
  virtual Result<void> start(AudioSource& source) = 0;
  // No render() runs when it returns. Stopping twice is fine.
  virtual void stop() = 0;
  // From any thread.
  virtual AudioStatus status() const = 0;
};

}  // namespace intaglio::sound
