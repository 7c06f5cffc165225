// The servo loop: a thread that ticks a PenServo, and histograms of its latency.
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "core/lock_free.h"
#include "haptics/servo.h"

namespace intaglio::haptics {

// A histogram of short times, written by one real-time thread and read by any. Buckets are a quarter of an
// octave (19 %) wide, from 1 ns to 17 s.
class LatencyHistogram {
 public:
  void add(double seconds) {
    const double octaves = seconds > 1e-9 ? 4 * std::log2(1e9 * seconds) : 0;
    auto& count = counts_[std::size_t(std::min(octaves, double(buckets - 1)))];
    count.store(count.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    if (seconds > max_.load(std::memory_order_relaxed)) max_.store(seconds, std::memory_order_relaxed);
  }
  std::uint64_t count() const {
    std::uint64_t sum = 0;
    for (const auto& c : counts_) sum += c.load(std::memory_order_relaxed);
    return sum;
  }
  // Upper edge of the bucket that holds the quantile q, seconds; 0 without any times.
  double quantile(double q) const {
    const double rank = q * double(count());
    double sum = 0;
    for (std::size_t k = 0; k < buckets; ++k) {
      sum += double(counts_[k].load(std::memory_order_relaxed));
      if (sum >= rank && sum > 0) return 1e-9 * std::exp2(double(k + 1) / 4);
    }
    return 0;
  }
  double max() const { return max_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::size_t buckets = 136;

  std::array<std::atomic<std::uint64_t>, buckets> counts_{};
  std::atomic<double> max_{0};
};

// Ticks a PenServo at 1, 4 or 8 kHz on a thread of its own, independent of the scene.
//
// Scene and loop exchange values through latest-value slots: neither waits for the other. The scene publishes
// a snapshot at every step, also when nothing moved: it is the heartbeat, and 20 ms without one is a fault
// that releases the hand (guard.h). The thread runs SCHED_FIFO where it may and reports when it may not
// (priority()). Late ticks are skipped, never caught up. The thread neither allocates nor locks. start(),
// stop(), publish(), latest() and rearm() belong to one thread, the scene's.
class ServoLoop {
 public:
  // `device` must outlive the loop, whose thread owns it between start() and stop().
  ServoLoop(PenServo servo, Device& device);
  ~ServoLoop();
  ServoLoop(const ServoLoop&) = delete;
  ServoLoop& operator=(const ServoLoop&) = delete;

  void start();
  // Releases the hand and joins the thread.
  void stop();

  // Seconds on the loop's clock (monotonic, from construction).
  double now() const;
  // Sets the snapshot's time to now() and passes it to the loop.
  void publish(SceneSnapshot scene);
  // The newest report, valid until the next call; `ticks` grows with each new one.
  const ServoReport& latest() { return report_.fetch(); }
  // Clears a latched fault of the guard before the next tick.
  void rearm() { rearm_.store(true, std::memory_order_release); }

  // How the thread is scheduled, one line; final after the first tick.
  std::string priority() const;
  // How late ticks woke up, and how long they took (device included).
  const LatencyHistogram& wake_up() const { return wake_up_; }
  const LatencyHistogram& compute() const { return compute_; }
  std::uint64_t skipped_ticks() const { return skipped_ticks_.load(std::memory_order_relaxed); }

 private:
  void run();
  void tick(double now);

  PenServo servo_;
  Device& device_;
  double start_time_;  // s, monotonic
  Latest<SceneSnapshot> scene_;
  Latest<ServoReport> report_;
  std::atomic<bool> running_{false}, rearm_{false};
  std::atomic<int> scheduling_{-1};  // 0: SCHED_FIFO; else errno
  std::atomic<std::uint64_t> skipped_ticks_{0};
  LatencyHistogram wake_up_, compute_;
  std::thread thread_;
};

}  // namespace intaglio::haptics
