#include "session/cost_meter.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>

namespace intaglio::session {

namespace {

constexpr double bin_ratio = 1.01;
constexpr std::size_t bin_count = 2600;  // up to 170 s

}  // namespace

std::int64_t cpu_ns(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return std::int64_t(t.tv_sec) * 1'000'000'000 + t.tv_nsec;
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
  return std::size_t(usage.ru_maxrss) * 1024;
}

void CostMeter::add(std::int64_t ns) {
  bins_.resize(bin_count);
  const double bin = std::log(double(std::max<std::int64_t>(ns, 1))) / std::log(bin_ratio);
  ++bins_[std::min(std::size_t(bin), bin_count - 1)];
  ++steps_;
  total_ns_ += ns;
}

// The middle of the bin in which the step of that rank lies.
double CostMeter::quantile_us(double q) const {
  auto rank = std::uint64_t(q * double(steps_ - 1));
  std::size_t bin = 0;
  while (rank >= bins_[bin]) rank -= bins_[bin++];
  return std::pow(bin_ratio, double(bin) + 0.5) * 1e-3;
}

SenseCost CostMeter::summarise(SenseCost cost) const {
  cost.steps = steps_;
  if (steps_ == 0) return cost;
  cost.median_us = quantile_us(0.5);
  cost.p99_us = quantile_us(0.99);
  cost.total_s = double(total_ns_) * 1e-9;
  return cost;
}

}  // namespace intaglio::session
