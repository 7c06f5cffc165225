// The servo loop: a thread of its own that ticks a PenServo at 1, 4 or 8 kHz, whatever the scene does.
//
// Scene and loop exchange values through latest-value slots: neither waits for the other. The scene publishes
// a snapshot at every step, also when nothing moved: it is the heartbeat, and 20 ms without one is a fault
// that lets go of the hand (guard.h). The thread runs SCHED_FIFO where it may and says so where it may not
// (priority()). A tick that comes later than a period is made up for by leaving ticks out, never by hurrying.
// The thread neither allocates nor locks. start(), stop(), publish(), latest(), rearm(): one thread, the
// scene's.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "intaglio/core/latest.h"
#include "intaglio/haptics/lateness.h"
#include "intaglio/haptics/servo.h"

namespace intaglio::haptics {

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
