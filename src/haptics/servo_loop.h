// A histogram of short times: how late, how long. Written by one real-time thread, read by any.
//
// Buckets are a quarter of an octave (19 %) wide, from 1 ns to 17 s; add() is one relaxed store.
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

// The servo loop: a thread of its own that ticks a PenServo at 1, 4 or 8 kHz, whatever the scene does.
//
// Scene and loop exchange values through latest-value slots: neither waits for the other. The scene publishes
// a snapshot at every step, also when nothing moved: it is the heartbeat, and 20 ms without one is a fault
// that lets go of the hand (guard.h). The thread runs SCHED_FIFO where it may and says so where it may not
// (priority()). A tick that comes later than a period is made up for by leaving ticks out, never by hurrying.
// The thread neither allocates nor locks. start(), stop(), publish(), latest(), rearm(): one thread, the
// scene's.

class ServoLoop {
 public:
  // `device` outlives the loop and is the loop thread's between start() and stop().
  ServoLoop(PenServo servo, Device& device);
  ~ServoLoop();
  ServoLoop(const ServoLoop&) = delete;
  ServoLoop& operator=(const ServoLoop&) = delete;

  void start();
  // Lets go of the hand, joins the thread.
  void stop();

  // Seconds on the loop's clock (monotonic, from construction).
  double now() const;
  // Hands the scene over; its time becomes now().
  void publish(SceneSnapshot scene);
  // The newest report; its `ticks` tell whether it is a new one. Valid until the next call.
  const ServoReport& latest() { return report_.fetch(); }
  // Clears a fault of the guard before the next tick.
  void rearm() { rearm_.store(true, std::memory_order_release); }

  // How the thread was scheduled, one line; complete once the first tick is made.
  std::string priority() const;
  // How late ticks woke up, and how long they took to compute (device included).
  const Lateness& wake_up() const { return wake_up_; }
  const Lateness& compute() const { return compute_; }
  std::uint64_t left_out() const { return left_out_.load(std::memory_order_relaxed); }

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
  std::atomic<std::uint64_t> left_out_{0};
  Lateness wake_up_, compute_;
  std::thread thread_;
};

}  // namespace intaglio::haptics
