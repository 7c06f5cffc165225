#include "study/statistics/effect_size.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "study/statistics/distributions.h"
#include "study/statistics/t_test.h"

namespace intaglio::statistics {
namespace {

// An effect size that divides the difference of a test by `deviation`.
EffectSize standardised(const char* name, const TTest& test, double deviation, double level, bool is_exact) {
  EffectSize effect;
  effect.name = name;
  effect.df = test.df;
  effect.interval_method = is_exact ? "noncentral t" : "noncentral t of the test, scaled (approximate)";
  if (!(deviation > 0) || !(test.standard_error > 0)) {
    effect.d = effect.g = undefined;
    effect.interval = {undefined, undefined};
    effect.note = "no value varies: there is no standardised difference";
    return effect;
  }
  effect.d = test.difference / deviation;
  effect.g = effect.d * hedges_correction(test.df);
  if (std::isnan(effect.g)) effect.note = "Hedges' correction needs more than one degree of freedom";
  const double scale = test.standard_error / deviation;
  const Interval reach = noncentrality_interval(test.t, test.df, level);
  effect.interval = {scale * reach.low, scale * reach.high};
  return effect;
}

Result<TTest> independent_test(const char* name, const Summary& first, const Summary& second, double level) {
  TTestOptions options;
  options.level = level;
  auto test = student_t_test(first, second, options);
  if (!test) return tl::unexpected(with_where(name, test.error()));
  return test;
}

struct PairedTest {
  TTest test;
  Summary first, second;
  double correlation = 0;
};

Result<PairedTest> paired_test(const char* name, std::span<const double> first,
                               std::span<const double> second, double level) {
  const auto pairs = complete_pairs(first, second, name);
  if (!pairs) return tl::unexpected(pairs.error());
  TTestOptions options;
  options.level = level;
  auto test = paired_t_test(first, second, options);
  if (!test) return tl::unexpected(with_where(name, test.error()));
  return PairedTest{*test, summary_of({pairs->first, 0}), summary_of({pairs->second, 0}),
                    correlation(pairs->first, pairs->second)};
}

double average_sd(const Summary& first, const Summary& second) {
  return std::sqrt((first.sd * first.sd + second.sd * second.sd) / 2);
}

}  // namespace

double hedges_correction(double df) {
  if (!(df > 1)) return undefined;
  return std::exp(log_gamma(df / 2) - log_gamma((df - 1) / 2)) / std::sqrt(df / 2);
}

Interval noncentrality_interval(double t, double df, double level) {
  return {noncentrality(t, df, (1 + level) / 2), noncentrality(t, df, (1 - level) / 2)};
}

Result<EffectSize> d_pooled(const Summary& first, const Summary& second, double level) {
  const auto test = independent_test("d_pooled", first, second, level);
  if (!test) return tl::unexpected(test.error());
  return standardised("d_pooled", *test, pooled_sd(first, second), level, true);
}

Result<EffectSize> d_av(const Summary& first, const Summary& second, double level) {
  const auto test = independent_test("d_av", first, second, level);
  if (!test) return tl::unexpected(test.error());
  return standardised("d_av", *test, average_sd(first, second), level, first.n == second.n);
}

Result<EffectSize> glass_delta(const Summary& first, const Summary& second, double level) {
  const auto test = independent_test("glass", first, second, level);
  if (!test) return tl::unexpected(test.error());
  return standardised("glass", *test, second.sd, level, false);
}

Result<EffectSize> d_z(std::span<const double> first, std::span<const double> second, double level) {
  const auto paired = paired_test("d_z", first, second, level);
  if (!paired) return tl::unexpected(paired.error());
  const double deviation = paired->test.standard_error * std::sqrt(double(paired->test.n1));
  return standardised("d_z", paired->test, deviation, level, true);
}

Result<EffectSize> d_rm(std::span<const double> first, std::span<const double> second, double level) {
  const auto paired = paired_test("d_rm", first, second, level);
  if (!paired) return tl::unexpected(paired.error());
  const double apart = std::sqrt(std::max(0.0, 2 * (1 - paired->correlation)));
  const double deviation = paired->test.standard_error * std::sqrt(double(paired->test.n1));
  EffectSize effect = standardised("d_rm", paired->test, apart > 0 ? deviation / apart : 0, level, false);
  if (!(apart > 0) && deviation > 0)
    effect.note = "the pairs are correlated by 1, or one side does not vary: d_rm is undefined";
  return effect;
}

Result<EffectSize> paired_d_av(std::span<const double> first, std::span<const double> second, double level) {
  const auto paired = paired_test("paired d_av", first, second, level);
  if (!paired) return tl::unexpected(paired.error());
  return standardised("paired d_av", paired->test, average_sd(paired->first, paired->second), level, false);
}

}  // namespace intaglio::statistics
