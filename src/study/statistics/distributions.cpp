#include "study/statistics/distributions.h"

#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/non_central_t.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <limits>
#include <numbers>

namespace intaglio::statistics {
namespace {

namespace policies = boost::math::policies;

using Quiet = policies::policy<
    policies::domain_error<policies::ignore_error>, policies::pole_error<policies::ignore_error>,
    policies::overflow_error<policies::ignore_error>, policies::underflow_error<policies::ignore_error>,
    policies::evaluation_error<policies::ignore_error>, policies::rounding_error<policies::ignore_error>,
    policies::indeterminate_result_error<policies::ignore_error>, policies::promote_double<false>>;
using Normal = boost::math::normal_distribution<double, Quiet>;
using StudentT = boost::math::students_t_distribution<double, Quiet>;
using ChiSquared = boost::math::chi_squared_distribution<double, Quiet>;
using NoncentralT = boost::math::non_central_t_distribution<double, Quiet>;
using Beta = boost::math::beta_distribution<double, Quiet>;
using Binomial = boost::math::binomial_distribution<double, Quiet>;

constexpr double infinite = std::numeric_limits<double>::infinity();

bool is_probability(double p) {
  return p >= 0 && p <= 1;
}

bool is_binomial(double successes, double trials, double p) {
  return trials >= 0 && std::floor(trials) == trials && std::isfinite(trials) && is_probability(p) &&
         std::floor(successes) == successes && std::isfinite(successes);
}

}  // namespace

double normal_density(double x) {
  return std::exp(-x * x / 2) / std::sqrt(2 * std::numbers::pi);
}

double normal_cdf(double x) {
  return std::erfc(-x / std::numbers::sqrt2) / 2;
}

double normal_upper(double x) {
  return std::erfc(x / std::numbers::sqrt2) / 2;
}

double normal_quantile(double p) {
  if (!is_probability(p)) return undefined;
  if (p == 0 || p == 1) return p == 0 ? -infinite : infinite;
  return quantile(Normal(), p);
}

double t_cdf(double t, double df) {
  if (std::isnan(t) || !(df > 0)) return undefined;
  if (std::isinf(df)) return normal_cdf(t);
  if (std::isinf(t)) return t > 0 ? 1 : 0;
  return cdf(StudentT(df), t);
}

double t_upper(double t, double df) {
  return t_cdf(-t, df);
}

double t_two_sided(double t, double df) {
  return 2 * t_cdf(-std::abs(t), df);
}

double t_quantile(double p, double df) {
  if (!is_probability(p) || !(df > 0)) return undefined;
  if (p == 0 || p == 1 || std::isinf(df)) return normal_quantile(p);
  return quantile(StudentT(df), p);
}

double chi_squared_upper(double x, double df) {
  if (std::isnan(x) || !(df > 0) || std::isinf(df)) return undefined;
  if (x <= 0) return 1;
  return std::isinf(x) ? 0 : cdf(complement(ChiSquared(df), x));
}

double noncentral_t_cdf(double t, double df, double noncentrality) {
  if (std::isnan(t) || !(df > 0) || !std::isfinite(noncentrality)) return undefined;
  if (std::isinf(df)) return normal_cdf(t - noncentrality);
  if (std::isinf(t)) return t > 0 ? 1 : 0;
  if (noncentrality == 0) return t_cdf(t, df);
  return cdf(NoncentralT(df, noncentrality), t);
}

double noncentral_t_upper(double t, double df, double noncentrality) {
  return noncentral_t_cdf(-t, df, -noncentrality);
}

double noncentrality(double t, double df, double p) {
  if (!std::isfinite(t) || !(df > 0) || !(p > 0 && p < 1)) return undefined;
  const auto excess = [&](double delta) { return noncentral_t_cdf(t, df, delta) - p; };
  double reach = 1 + std::abs(t) / 4;
  while (reach < 1e6 && !(excess(t - reach) > 0 && excess(t + reach) < 0)) reach *= 2;
  return find_root(excess, t - reach, t + reach);
}

double beta_quantile(double p, double a, double b) {
  if (!is_probability(p) || !(a > 0) || !(b > 0) || std::isinf(a) || std::isinf(b)) return undefined;
  return quantile(Beta(a, b), p);
}

double binomial_pmf(double successes, double trials, double p) {
  if (!is_binomial(successes, trials, p)) return undefined;
  return successes < 0 || successes > trials ? 0 : pdf(Binomial(trials, p), successes);
}

double binomial_cdf(double successes, double trials, double p) {
  if (!is_binomial(successes, trials, p)) return undefined;
  if (successes < 0) return 0;
  return successes >= trials ? 1 : cdf(Binomial(trials, p), successes);
}

double binomial_upper(double successes, double trials, double p) {
  return binomial_cdf(trials - successes, trials, 1 - p);
}

double log_gamma(double x) {
  return x > 0 ? boost::math::lgamma(x, Quiet()) : undefined;
}

double find_root(const std::function<double(double)>& function, double low, double high) {
  double at_low = function(low);
  const double at_high = function(high);
  if (at_low == 0) return low;
  if (at_high == 0) return high;
  if (!(at_low * at_high < 0)) return undefined;
  while (true) {
    const double middle = low + (high - low) / 2;
    if (middle <= low || middle >= high) return middle;
    const double at_middle = function(middle);
    if (std::isnan(at_middle)) return undefined;
    if (at_middle == 0) return middle;
    if ((at_middle < 0) == (at_low < 0)) {
      low = middle;
      at_low = at_middle;
    } else {
      high = middle;
    }
  }
}

}  // namespace intaglio::statistics
