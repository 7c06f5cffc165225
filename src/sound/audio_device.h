// Where live sound goes: something that asks for samples when it needs them.
//
// A device pulls: it calls AudioSource::render() from a thread of its own until it is stopped. Samples are
// interleaved left, right, in -1..1. Kinds: a sound card (devices.h), one that plays to nobody in real
// time (devices.h), and one whose clock a test turns (test_clock_device.h); devices.h chooses.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <span>
#include <string>

#include "intaglio/error.h"

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

// Counts and times the render() calls of an audio device. Written by the device's thread, read by any.

class RenderMeter {
 public:
  // Renders `stereo` from `source` and remembers how long it took beside the time that it plays for.
  void render(AudioSource& source, std::span<float> stereo, int sample_rate) noexcept {
    const auto start = std::chrono::steady_clock::now();
    source.render(stereo);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    const double busy = took.count() * 2 * sample_rate / static_cast<double>(stereo.size());
    if (busy > busiest_.load(std::memory_order_relaxed)) busiest_.store(busy, std::memory_order_relaxed);
    buffers_.fetch_add(1, std::memory_order_relaxed);
  }
  void count_underruns(std::uint64_t count) noexcept {
    underruns_.fetch_add(count, std::memory_order_relaxed);
  }
  AudioStatus status(double latency) const {
    return {buffers_.load(std::memory_order_relaxed), underruns_.load(std::memory_order_relaxed), latency,
            busiest_.load(std::memory_order_relaxed), ""};
  }

 private:
  std::atomic<std::uint64_t> buffers_{0}, underruns_{0};
  std::atomic<double> busiest_{0};
};

}  // namespace intaglio::sound
