#include "study/statistics/power.h"

#include <fmt/format.h>

#include <cmath>

#include "study/statistics/distributions.h"

namespace intaglio::statistics {
namespace {

constexpr const char* power_name = "power of a t-test";

double power_of(double noncentrality, double df, const PowerOptions& options) {
  if (options.alternative == Alternative::less) noncentrality = -noncentrality;
  const bool two = options.alternative == Alternative::two_sided;
  const double critical = -t_quantile(two ? options.alpha / 2 : options.alpha, df);
  const double above = noncentral_t_upper(critical, df, noncentrality);
  return two ? above + noncentral_t_cdf(-critical, df, noncentrality) : above;
}

Result<void> check_power(double d, const PowerOptions& options) {
  if (!std::isfinite(d))
    return fail(power_name, fmt::format("the effect is {}", d), "an effect is a finite number");
  if (!(options.alpha > 0 && options.alpha < 1))
    return fail(power_name, fmt::format("alpha is {}", options.alpha), "alpha lies between 0 and 1");
  return {};
}

// The least n for which `power_at` reaches a power: it rises with n.
template <class Power>
Result<std::size_t> least_size(double d, double power, const PowerOptions& options, const Power& power_at) {
  if (auto checked = check_power(d, options); !checked) return tl::unexpected(checked.error());
  if (!(power > 0 && power < 1))
    return fail(power_name, fmt::format("the power is {}", power), "a power lies between 0 and 1");
  if (d == 0 || (options.alternative == Alternative::greater && d < 0) ||
      (options.alternative == Alternative::less && d > 0))
    return fail(power_name, fmt::format("no sample size detects an effect of {}", d),
                "give the effect in the direction of the test");
  constexpr std::size_t most = 10'000'000;
  std::size_t low = 1, high = 2;  // too few, and enough
  while (power_at(high) < power) {
    if (high >= most)
      return fail(power_name, fmt::format("an effect of {} needs more than {} values", d, most),
                  "give a greater effect or a lower power");
    low = high;
    high *= 2;
  }
  while (high - low > 1) {
    const std::size_t middle = low + (high - low) / 2;
    (power_at(middle) < power ? low : high) = middle;
  }
  return high;
}

}  // namespace

Result<double> independent_power(double d, std::size_t n1, std::size_t n2, const PowerOptions& options) {
  if (auto checked = check_power(d, options); !checked) return tl::unexpected(checked.error());
  if (n1 < 2 || n2 < 2)
    return fail(power_name, fmt::format("the groups have {} and {} values", n1, n2), "give at least 2");
  const double a = double(n1), b = double(n2);
  return power_of(d * std::sqrt(a * b / (a + b)), a + b - 2, options);
}

Result<double> paired_power(double d_z, std::size_t pairs, const PowerOptions& options) {
  if (auto checked = check_power(d_z, options); !checked) return tl::unexpected(checked.error());
  if (pairs < 2) return fail(power_name, fmt::format("there is {} pair", pairs), "give at least 2");
  return power_of(d_z * std::sqrt(double(pairs)), double(pairs) - 1, options);
}

Result<std::size_t> independent_size(double d, double power, const PowerOptions& options) {
  return least_size(d, power, options, [&](std::size_t n) { return *independent_power(d, n, n, options); });
}

Result<std::size_t> paired_size(double d_z, double power, const PowerOptions& options) {
  return least_size(d_z, power, options, [&](std::size_t n) { return *paired_power(d_z, n, options); });
}

}  // namespace intaglio::statistics
