#include "study/statistics/family.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "study/statistics/distributions.h"

namespace intaglio::statistics {

Result<std::vector<double>> holm(std::span<const double> p) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < p.size(); ++k) {
    if (p[k] < 0 || p[k] > 1)
      return fail("Holm", fmt::format("p {} is {}", k + 1, p[k]), "a p lies between 0 and 1");
    if (!std::isnan(p[k])) order.push_back(k);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  std::vector<double> adjusted(p.size(), undefined);
  double least = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    least = std::max(least, std::min(1.0, double(order.size() - k) * p[order[k]]));
    adjusted[order[k]] = least;
  }
  return adjusted;
}

}  // namespace intaglio::statistics
