#include "study/statistics/proportion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "study/statistics/distributions.h"

namespace intaglio::statistics {
namespace {

// Outcomes as likely as the observed one count as such, in spite of rounding.
constexpr double as_likely = 1 + 1e-7;

Result<void> check_counts(const char* what, std::size_t successes, std::size_t trials) {
  if (trials == 0) return fail(what, "there are no trials", "give at least one");
  if (successes > trials)
    return fail(what, fmt::format("{} of {} trials are successes", successes, trials),
                "successes are at most as many as trials");
  return {};
}

Result<void> check_fraction(const char* what, const char* name, double value) {
  if (value > 0 && value < 1) return {};
  return fail(what, fmt::format("the {} is {}", name, value), fmt::format("a {} lies between 0 and 1", name));
}

Result<Proportion> checked_proportion(const char* what, std::size_t successes, std::size_t trials,
                                      double level) {
  if (auto checked = check_counts(what, successes, trials); !checked) return tl::unexpected(checked.error());
  if (auto checked = check_fraction(what, "level", level); !checked) return tl::unexpected(checked.error());
  return Proportion{successes, trials, double(successes) / double(trials), {}, what};
}

double log_choose(double n, double k) {
  return log_gamma(n + 1) - log_gamma(k + 1) - log_gamma(n - k + 1);
}

// Fisher's probabilities of k successes in the first group, given all successes.
struct FisherTails {
  double two_sided = 0, greater = 0;
};

FisherTails fisher_tails(double k1, double n1, double k2, double n2) {
  const double successes = k1 + k2, all = log_choose(n1 + n2, successes);
  const double low = std::max(0.0, successes - n2), high = std::min(n1, successes);
  const auto probability = [&](double k) {
    return std::exp(log_choose(n1, k) + log_choose(n2, successes - k) - all);
  };
  const double observed = probability(k1);
  FisherTails tails;
  for (double k = low; k <= high; ++k) {
    const double p = probability(k);
    if (p <= observed * as_likely) tails.two_sided += p;
    if (k >= k1) tails.greater += p;
  }
  return {std::min(1.0, tails.two_sided), std::min(1.0, tails.greater)};
}

}  // namespace

Result<Proportion> clopper_pearson(std::size_t successes, std::size_t trials, double level) {
  auto result = checked_proportion("Clopper-Pearson", successes, trials, level);
  if (!result) return result;
  const double k = double(successes), n = double(trials), tail = (1 - level) / 2;
  result->interval.low = successes == 0 ? 0 : beta_quantile(tail, k, n - k + 1);
  result->interval.high = successes == trials ? 1 : beta_quantile(1 - tail, k + 1, n - k);
  return result;
}

Result<Proportion> wilson(std::size_t successes, std::size_t trials, double level) {
  auto result = checked_proportion("Wilson", successes, trials, level);
  if (!result) return result;
  const double n = double(trials), p = result->rate, z = normal_quantile((1 + level) / 2), zz = z * z;
  const double middle = (p + zz / (2 * n)) / (1 + zz / n);
  const double reach = z / (1 + zz / n) * std::sqrt(p * (1 - p) / n + zz / (4 * n * n));
  result->interval.low = successes == 0 ? 0 : middle - reach;
  result->interval.high = successes == trials ? 1 : middle + reach;
  return result;
}

Result<ChanceTest> binomial_test(std::size_t successes, std::size_t trials, double chance) {
  constexpr const char* what = "binomial test";
  if (auto checked = check_counts(what, successes, trials); !checked) return tl::unexpected(checked.error());
  if (auto checked = check_fraction(what, "chance", chance); !checked) return tl::unexpected(checked.error());
  const double k = double(successes), n = double(trials);
  ChanceTest test{chance, binomial_upper(k, n, chance), binomial_cdf(k, n, chance), 0};
  const double observed = binomial_pmf(k, n, chance);
  for (std::size_t other = 0; other <= trials; ++other) {
    const double p = binomial_pmf(double(other), n, chance);
    if (p <= observed * as_likely) test.p_two_sided += p;
  }
  test.p_two_sided = std::min(1.0, test.p_two_sided);
  return test;
}

Result<TwoProportions> two_proportions(std::size_t successes1, std::size_t trials1, std::size_t successes2,
                                       std::size_t trials2) {
  constexpr const char* what = "two proportions";
  if (auto checked = check_counts(what, successes1, trials1); !checked)
    return tl::unexpected(checked.error());
  if (auto checked = check_counts(what, successes2, trials2); !checked)
    return tl::unexpected(checked.error());
  const double k1 = double(successes1), n1 = double(trials1), k2 = double(successes2), n2 = double(trials2);
  const double p1 = k1 / n1, p2 = k2 / n2, p = (k1 + k2) / (n1 + n2);
  TwoProportions test;
  test.difference = p1 - p2;
  const auto z = [&](double variance) {
    return variance > 0 ? test.difference / std::sqrt(variance) : undefined;
  };
  test.z_pooled = z(p * (1 - p) * (1 / n1 + 1 / n2));
  test.z_unpooled = z(p1 * (1 - p1) / n1 + p2 * (1 - p2) / n2);
  test.p_pooled = 2 * normal_upper(std::abs(test.z_pooled));
  test.p_unpooled = 2 * normal_upper(std::abs(test.z_unpooled));
  const FisherTails tails = fisher_tails(k1, n1, k2, n2);
  test.fisher = tails.two_sided;
  test.fisher_greater = tails.greater;
  if (std::isnan(test.z_unpooled)) test.note = "both rates are 0 or 1: a z has no error to divide by";
  return test;
}

}  // namespace intaglio::statistics
