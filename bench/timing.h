// Times that were measured, and what they are summed up by.
#pragma once

#include <time.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace intaglio::bench {

// CPU time of the process, all threads of the graphics driver included.
inline double process_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

struct Summary {
  double median = 0, p99 = 0;
};

inline Summary summary(std::vector<double> times) {
  if (times.empty()) return {};
  std::sort(times.begin(), times.end());
  return {times[times.size() / 2], times[times.size() * 99 / 100]};
}

}  // namespace intaglio::bench
