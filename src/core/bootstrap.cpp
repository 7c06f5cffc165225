#include "core/bootstrap.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "core/portable_math.h"

namespace intaglio {
namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

double quantile_of_sorted(std::span<const double> sorted, double fraction) {
  const double place = fraction * double(sorted.size() - 1);
  const auto below = std::min(std::size_t(place), sorted.size() - 1);
  const auto above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - double(below)) * (sorted[above] - sorted[below]);
}

}  // namespace

double mean(std::span<const double> values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return values.empty() ? no_value : sum / double(values.size());
}

double quantile(std::span<const double> values, double fraction) {
  assert(fraction >= 0 && fraction <= 1);
  if (values.empty()) return no_value;
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  return quantile_of_sorted(sorted, fraction);
}

Interval bootstrap_interval(std::span<const double> values, const Statistic& statistic,
                            const BootstrapOptions& options) {
  assert(options.resamples >= 1 && options.level > 0 && options.level < 1);
  if (values.empty()) return {no_value, no_value};
  Random random(options.seed);
  std::vector<double> sample(values.size());
  std::vector<double> statistics;
  statistics.reserve(std::size_t(options.resamples));
  for (int k = 0; k < options.resamples; ++k) {
    for (double& value : sample) value = values[std::size_t(random.uniform() * double(values.size()))];
    statistics.push_back(statistic(sample));
  }
  std::sort(statistics.begin(), statistics.end());
  const double tail = (1 - options.level) / 2;
  return {quantile_of_sorted(statistics, tail), quantile_of_sorted(statistics, 1 - tail)};
}

}  // namespace intaglio
