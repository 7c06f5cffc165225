// Adds the CPU time that the thread spends in a scope to a sum, in seconds.
#pragma once

#include <time.h>

namespace intaglio::evaluate {

inline double cpu_seconds(clockid_t clock = CLOCK_THREAD_CPUTIME_ID) {
  timespec t;
  clock_gettime(clock, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

class CpuTimer {
 public:
  explicit CpuTimer(double& sum) : sum_(sum), start_(cpu_seconds()) {}
  ~CpuTimer() { sum_ += cpu_seconds() - start_; }
  CpuTimer(const CpuTimer&) = delete;
  CpuTimer& operator=(const CpuTimer&) = delete;

 private:
  double& sum_;
  double start_;
};

}  // namespace intaglio::evaluate
