// The cost of one sense's steps, in CPU time, so that other load does not count.
//
// Quantiles come from a histogram whose bins are 1 % wide, so that memory does not depend on the number of
// steps; totals are exact.
#pragma once

#include <time.h>

#include <cstdint>
#include <string>
#include <vector>

namespace intaglio::session {

// The cost of one sense, thread-CPU time.
struct SenseCost {
  std::string sense;        // "dynamics", "haptics", "sound", "picture"
  std::string step;         // "1/480 s step", "64-sample block", "640x360 frame"
  double step_seconds = 0;  // simulated time per step
  std::size_t steps = 0;
  double median_us = 0;  // within 0.5 %, as p99_us
  double p99_us = 0;
  double total_s = 0;
};

// CPU time in nanoseconds: of a POSIX clock (pthread_getcpuclockid), the calling thread, the process.
std::int64_t cpu_ns(clockid_t clock);
std::int64_t thread_cpu_ns();
std::int64_t process_cpu_ns();
// Largest resident size of the process so far, bytes.
std::size_t peak_memory_bytes();

// One meter per thread.
class CostMeter {
 public:
  // Runs step() and records its cost.
  template <class Step>
  void measure(Step&& step) {
    const std::int64_t start = thread_cpu_ns();
    step();
    add(thread_cpu_ns() - start);
  }
  void add(std::int64_t ns);

  // Fills steps, median, p99 and total of `cost`.
  SenseCost summarise(SenseCost cost) const;

 private:
  double quantile_us(double q) const;

  std::vector<std::uint64_t> bins_;  // of steps, by the logarithm of their cost
  std::size_t steps_ = 0;
  std::int64_t total_ns_ = 0;
};

}  // namespace intaglio::session
