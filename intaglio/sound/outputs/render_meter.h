// Counts and times the render() calls of an audio device. Written by the device's thread, read by any.
#pragma once

#include <atomic>
#include <chrono>

#include "intaglio/sound/outputs/audio_device.h"

namespace intaglio::sound {

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
