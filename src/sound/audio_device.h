// Audio output devices (pull model).
//
// A device calls AudioSource::render() from a thread of its own until it is stopped. Samples are interleaved
// left, right, in -1..1. Kinds: a sound card, and a null device that discards its samples in real time
// (audio/devices.h).
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
  std::uint64_t buffers = 0;    // rendered
  std::uint64_t underruns = 0;  // buffers that were late, as far as the device can tell
  double latency = 0;           // s, from render() to the speaker: what is buffered below us
  double peak_load = 0;         // the longest render(), as a fraction of the buffer's duration
  std::string error;            // reason for an unexpected stop, else empty
};

class AudioDevice {
 public:
  // Stops the device.
  virtual ~AudioDevice() = default;

  virtual std::string name() const = 0;
  virtual int sample_rate() const = 0;    // Hz, actual
  virtual int buffer_frames() const = 0;  // of a typical render()

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
  // Renders `stereo` from `source`, and compares the time that takes with the time that it plays for.
  void render(AudioSource& source, std::span<float> stereo, int sample_rate) noexcept {
    const auto start = std::chrono::steady_clock::now();
    source.render(stereo);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    const double busy = took.count() * 2 * sample_rate / double(stereo.size());
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
