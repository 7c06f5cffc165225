// Standardised differences of means, by the name of their formula, with intervals by the noncentral t.
//
//   d_pooled   (m1 - m2) / s, s pooled by degrees of freedom as in Student's test      independent
//   d_av       (m1 - m2) / sqrt((s1² + s2²) / 2)                                       independent or paired
//   glass      (m1 - m2) / s2, the deviation of the second (control) sample            independent
//   d_z        mean of the differences / their deviation                               paired
//   d_rm       d_z sqrt(2 (1 - r)), r the correlation of the pairs                     paired
//   g          any of these times Γ(df/2) / (sqrt(df/2) Γ((df - 1)/2)), Hedges' exact correction
//
// d_pooled and d_av are one number where both samples have one size. The interval of d_pooled and d_z is
// exact for normal values: the noncentralities at which the observed t is the upper and the lower quantile.
// The others' are those of the test's noncentrality times d / t, which is approximate (Algina and Keselman
// 2003 for paired d_av); `interval_method` says which. No variance: not a number and a note. Sources: Cohen
// 1988; Lakens 2013 (names); Hedges 1981; Cumming and Finch 2001 (intervals). Any thread; about 1 ms, for
// the interval.
#pragma once

#include <span>
#include <string>

#include "core/bootstrap.h"
#include "study/statistics/sample.h"

namespace intaglio::statistics {

struct EffectSize {
  std::string name;  // "d_pooled"
  double d = 0, g = 0;
  double df = 0;      // of the correction and of the noncentral t
  Interval interval;  // of d
  std::string interval_method;
  std::string note;  // empty, or why there is no number
};

// From samples or printed means and deviations. Errors: as of a t-test.
Result<EffectSize> d_pooled(const Summary& first, const Summary& second, double level = 0.95);
Result<EffectSize> d_av(const Summary& first, const Summary& second, double level = 0.95);
Result<EffectSize> glass_delta(const Summary& first, const Summary& second, double level = 0.95);

// Pairs with a missing value are left out.
Result<EffectSize> d_z(std::span<const double> first, std::span<const double> second, double level = 0.95);
Result<EffectSize> d_rm(std::span<const double> first, std::span<const double> second, double level = 0.95);
Result<EffectSize> paired_d_av(std::span<const double> first, std::span<const double> second,
                               double level = 0.95);

// Hedges' correction; not a number for df of 1 or less.
double hedges_correction(double df);

// The noncentralities of a t that was observed: the ends of an interval of a level.
Interval noncentrality_interval(double t, double df, double level);

}  // namespace intaglio::statistics
