#include "study/statistics/detectability.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "study/statistics/distributions.h"

namespace intaglio::statistics {

double choice_rate(double d_prime, int alternatives) {
  // The error of such a sum falls as exp(-2 (π / step)²), far below rounding.
  constexpr double step = 1.0 / 16, reach = 9.5;
  double sum = 0;
  for (double x = -reach; x <= reach; x += step)
    sum += normal_density(x) * std::pow(normal_cdf(x + d_prime), alternatives - 1);
  return sum * step;
}

Result<double> detectability(double rate, int alternatives) {
  constexpr const char* what = "d'";
  if (!(rate >= 0 && rate <= 1))
    return fail(what, fmt::format("the rate is {}", rate), "a rate lies between 0 and 1");
  if (alternatives < 2)
    return fail(what, fmt::format("there are {} alternatives", alternatives), "there are at least 2");
  constexpr double infinite = std::numeric_limits<double>::infinity();
  if (rate == 0 || rate == 1) return rate == 0 ? -infinite : infinite;
  return find_root([&](double d) { return choice_rate(d, alternatives) - rate; }, -40, 40);
}

Result<Detectability> detectability(const Proportion& proportion, int alternatives) {
  const auto middle = detectability(proportion.rate, alternatives);
  if (!middle) return tl::unexpected(middle.error());
  const auto low = detectability(proportion.interval.low, alternatives);
  const auto high = detectability(proportion.interval.high, alternatives);
  if (!low) return tl::unexpected(low.error());
  if (!high) return tl::unexpected(high.error());
  return Detectability{*middle, {*low, *high}};
}

}  // namespace intaglio::statistics
