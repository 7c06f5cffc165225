// Proportions: exact intervals, exact tests against chance, and two proportions against each other.
//
//   Clopper-Pearson   the rates at which P(X >= k) and P(X <= k) are (1 - level)/2: beta quantiles
//   Wilson            the rates at which the normal test without correction is just not rejected
//   binomial test     P(X >= k); two-sided: all outcomes that are at most as likely as the observed one
//   z pooled          (p1 - p2) / sqrt(p (1 - p) (1/n1 + 1/n2)), p of both together
//   z unpooled        (p1 - p2) / sqrt(p1 (1 - p1)/n1 + p2 (1 - p2)/n2)
//   Fisher            hypergeometric, two-sided as the binomial test
//
// Sources: Clopper and Pearson 1934; Wilson 1927; Fisher 1935. Errors: no trials, more successes than
// trials, a chance or level outside (0, 1). Any thread; intervals take microseconds, tests are
// linear in the trials.
#pragma once

#include <cstddef>
#include <string>

#include "core/bootstrap.h"
#include "intaglio/error.h"

namespace intaglio::statistics {

struct Proportion {
  std::size_t successes = 0, trials = 0;
  double rate = 0;
  Interval interval;
  std::string interval_method;  // "Clopper-Pearson"
};

Result<Proportion> clopper_pearson(std::size_t successes, std::size_t trials, double level = 0.95);
Result<Proportion> wilson(std::size_t successes, std::size_t trials, double level = 0.95);

struct ChanceTest {
  double chance = 0;
  double p_greater = 0, p_less = 0, p_two_sided = 0;
};

Result<ChanceTest> binomial_test(std::size_t successes, std::size_t trials, double chance);

struct TwoProportions {
  double difference = 0;                  // first - second
  double z_pooled = 0, z_unpooled = 0;    // not a number where the error is 0
  double p_pooled = 0, p_unpooled = 0;    // two-sided
  double fisher = 0, fisher_greater = 0;  // two-sided, and of a first rate that is greater
  std::string note;
};

Result<TwoProportions> two_proportions(std::size_t successes1, std::size_t trials1, std::size_t successes2,
                                       std::size_t trials2);

}  // namespace intaglio::statistics
