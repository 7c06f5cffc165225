// A histogram of short times: how late, how long. Written by one real-time thread, read by any.
//
// Buckets are a quarter of an octave (19 %) wide, from 1 ns to 17 s; add() is one relaxed store.
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>

namespace intaglio::haptics {

class Lateness {
 public:
  void add(double seconds) {
    const double octaves = seconds > 1e-9 ? 4 * std::log2(1e9 * seconds) : 0;
    auto& count = counts_[static_cast<std::size_t>(std::min(octaves, static_cast<double>(buckets - 1)))];
    count.store(count.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    if (seconds > most_.load(std::memory_order_relaxed)) most_.store(seconds, std::memory_order_relaxed);
  }
  std::uint64_t count() const {
    std::uint64_t sum = 0;
    for (const auto& c : counts_) sum += c.load(std::memory_order_relaxed);
    return sum;
  }
  // Upper edge of the bucket below which the fraction q of all times lies, seconds; 0 when there are none.
  double quantile(double q) const {
    const double rank = q * static_cast<double>(count());
    double sum = 0;
    for (std::size_t k = 0; k < buckets; ++k) {
      sum += static_cast<double>(counts_[k].load(std::memory_order_relaxed));
      if (sum >= rank && sum > 0) return 1e-9 * std::exp2(static_cast<double>(k + 1) / 4);
    }
    return 0;
  }
  double most() const { return most_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::size_t buckets = 136;

  std::array<std::atomic<std::uint64_t>, buckets> counts_{};
  std::atomic<double> most_{0};
};

}  // namespace intaglio::haptics
