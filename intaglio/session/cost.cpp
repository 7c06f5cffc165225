#include "intaglio/session/cost.h"

#include <sys/resource.h>
#include <algorithm>
#include <numeric>

namespace intaglio::session {

std::int64_t cpu_ns(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<std::int64_t>(t.tv_sec) * 1'000'000'000 + t.tv_nsec;
}

std::int64_t thread_cpu_ns() {
  return cpu_ns(CLOCK_THREAD_CPUTIME_ID);
}
std::int64_t process_cpu_ns() {
  return cpu_ns(CLOCK_PROCESS_CPUTIME_ID);
}

std::size_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

SenseCost CostMeter::summary(SenseCost cost) const {
  cost.steps = ns_.size();
  if (ns_.empty()) return cost;
  std::vector<std::int64_t> sorted = ns_;
  std::sort(sorted.begin(), sorted.end());
  const auto quantile = [&](double q) {
    return static_cast<double>(sorted[static_cast<std::size_t>(q * static_cast<double>(sorted.size() - 1))]) *
           1e-3;
  };
  cost.median_us = quantile(0.5);
  cost.p99_us = quantile(0.99);
  cost.total_s = static_cast<double>(std::accumulate(ns_.begin(), ns_.end(), std::int64_t{0})) * 1e-9;
  return cost;
}

}  // namespace intaglio::session
