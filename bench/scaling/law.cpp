#include "bench/scaling/law.h"

#include <cmath>
#include <limits>

#include "bench/timing.h"

namespace intaglio::bench {

Fit fit(const Law& law) {
  const std::size_t n = law.sizes.size();
  std::vector<double> xs, ys;
  double mean_x = 0, mean_y = 0;
  for (std::size_t k = 0; k < n; ++k) {
    xs.push_back(std::log(law.sizes[k]));
    ys.push_back(std::log(law.costs[k]));
    mean_x += xs.back() / double(n);
    mean_y += ys.back() / double(n);
  }
  double xx = 0, xy = 0;
  for (std::size_t k = 0; k < n; ++k) {
    xx += (xs[k] - mean_x) * (xs[k] - mean_x);
    xy += (xs[k] - mean_x) * (ys[k] - mean_y);
  }
  Fit out;
  out.exponent = xy / xx;
  double residual = 0;
  for (std::size_t k = 0; k < n; ++k)
    residual += std::pow(ys[k] - mean_y - out.exponent * (xs[k] - mean_x), 2);
  out.standard_error = n > 2 ? std::sqrt(residual / double(n - 2) / xx) : std::nan("");
  out.last = n > 1 ? (ys[n - 1] - ys[n - 2]) / (xs[n - 1] - xs[n - 2]) : std::nan("");
  return out;
}

double holds_until(const Law& law) {
  if (law.costs.front() > law.limit) return 0;
  for (std::size_t k = 0; k + 1 < law.costs.size(); ++k) {
    if (law.costs[k + 1] <= law.limit) continue;
    const double share = std::log(law.limit / law.costs[k]) / std::log(law.costs[k + 1] / law.costs[k]);
    return law.sizes[k] * std::pow(law.sizes[k + 1] / law.sizes[k], share);
  }
  return std::numeric_limits<double>::infinity();
}

std::vector<double> interleaved(std::size_t count, int rounds,
                                const std::function<double(std::size_t)>& measure) {
  std::vector<std::vector<double>> all(count);
  for (int round = 0; round < rounds; ++round)
    for (std::size_t k = 0; k < count; ++k) all[k].push_back(measure(k));
  std::vector<double> out;
  for (const auto& values : all) out.push_back(summary(values).median);
  return out;
}

}  // namespace intaglio::bench
