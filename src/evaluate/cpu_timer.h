// Adds the CPU time that the thread spends in a scope to a sum, in seconds.
#pragma once

#include "session/cost_meter.h"

namespace intaglio::evaluate {

inline double cpu_seconds() {
  return 1e-9 * double(session::thread_cpu_ns());
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
