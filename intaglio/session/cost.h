// How long steps take, in CPU time of the calling thread: immune to whatever else the machine does.
#pragma once

#include <time.h>

#include <cstdint>
#include <vector>

#include "intaglio/session/recording.h"

namespace intaglio::session {

// CPU time by a POSIX clock (pthread_getcpuclockid), of the calling thread, or of the whole process, in
// nanoseconds.
std::int64_t cpu_ns(clockid_t clock);
std::int64_t thread_cpu_ns();
std::int64_t process_cpu_ns();
// Largest resident size of the process so far, bytes.
std::size_t peak_memory_bytes();

// Collects the cost of one sense's steps. Not thread-safe: one meter a thread.
class CostMeter {
 public:
  // Runs step() and notes what it cost.
  template <class Step>
  void measure(Step&& step) {
    const std::int64_t start = thread_cpu_ns();
    step();
    ns_.push_back(thread_cpu_ns() - start);
  }
  void add(std::int64_t ns) { ns_.push_back(ns); }

  // Fills steps, median, p99 and total of `cost`.
  SenseCost summary(SenseCost cost) const;

 private:
  std::vector<std::int64_t> ns_;
};

}  // namespace intaglio::session
