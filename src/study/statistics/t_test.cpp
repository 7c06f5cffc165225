#include "study/statistics/t_test.h"

#include <fmt/format.h>

#include <cmath>

#include "core/text.h"
#include "study/statistics/distributions.h"

namespace intaglio::statistics {
namespace {

// The test, once its difference, standard error and degrees of freedom are known.
TTest finished(TTest test, const TTestOptions& options) {
  if (!(test.standard_error > 0)) {
    test.t = test.p = undefined;
    test.interval = {undefined, undefined};
    test.note = "no value varies: there is no t-test";
    return test;
  }
  test.t = (test.difference - options.null_value) / test.standard_error;
  test.p = t_probability(test.t, test.df, options.alternative);
  const double reach = t_quantile((1 + options.level) / 2, test.df) * test.standard_error;
  test.interval = {test.difference - reach, test.difference + reach};
  return test;
}

Result<void> check_level(double level, const std::string& what) {
  if (level > 0 && level < 1) return {};
  return fail(what, fmt::format("the level is {}", level), "a level lies between 0 and 1, such as 0.95");
}

Result<TTest> two_samples(const char* name, const Summary& first, const Summary& second,
                          const TTestOptions& options) {
  if (auto checked = check_level(options.level, name); !checked) return tl::unexpected(checked.error());
  for (const Summary* sample : {&first, &second})
    if (auto checked = check_summary(*sample, name); !checked) return tl::unexpected(checked.error());
  TTest test;
  test.name = name;
  test.n1 = first.n;
  test.n2 = second.n;
  test.missing = first.missing + second.missing;
  test.difference = first.mean - second.mean;
  return test;
}

// The summaries of two samples, given to a test of summaries.
template <class Test>
Result<TTest> of_values(const char* name, std::span<const double> first, std::span<const double> second,
                        const Test& test) {
  const auto a = summary(first, name), b = summary(second, name);
  if (!a) return tl::unexpected(a.error());
  if (!b) return tl::unexpected(b.error());
  return test(*a, *b);
}

constexpr const char* student_name = "Student's t-test, independent, one variance";
constexpr const char* welch_name = "Welch's t-test, independent, two variances";

}  // namespace

double t_probability(double t, double df, Alternative alternative) {
  switch (alternative) {
    case Alternative::greater:
      return t_upper(t, df);
    case Alternative::less:
      return t_cdf(t, df);
    case Alternative::two_sided:
      break;
  }
  return t_two_sided(t, df);
}

double pooled_sd(const Summary& first, const Summary& second) {
  const double df1 = double(first.n) - 1, df2 = double(second.n) - 1;
  return std::sqrt((df1 * first.sd * first.sd + df2 * second.sd * second.sd) / (df1 + df2));
}

Result<void> check_summary(const Summary& sample, const std::string& what) {
  if (sample.n < 2)
    return fail(what, fmt::format("a sample has {} value{}", sample.n, sample.n == 1 ? "" : "s"),
                "a deviation needs at least two");
  if (!std::isfinite(sample.mean)) return fail(what, "a mean is not finite", "give a number");
  if (!(sample.sd >= 0) || std::isinf(sample.sd))
    return fail(what, fmt::format("a standard deviation is {}", sample.sd),
                "a deviation is finite and at least 0");
  return {};
}

Result<TTest> student_t_test(const Summary& first, const Summary& second, const TTestOptions& options) {
  auto test = two_samples(student_name, first, second, options);
  if (!test) return test;
  test->df = double(first.n + second.n) - 2;
  test->standard_error = pooled_sd(first, second) * std::sqrt(1 / double(first.n) + 1 / double(second.n));
  return finished(*test, options);
}

Result<TTest> student_t_test(std::span<const double> first, std::span<const double> second,
                             const TTestOptions& options) {
  return of_values(student_name, first, second,
                   [&](const Summary& a, const Summary& b) { return student_t_test(a, b, options); });
}

Result<TTest> welch_t_test(const Summary& first, const Summary& second, const TTestOptions& options) {
  auto test = two_samples(welch_name, first, second, options);
  if (!test) return test;
  const double a = first.sd * first.sd / double(first.n), b = second.sd * second.sd / double(second.n);
  test->standard_error = std::sqrt(a + b);
  test->df = (a + b) * (a + b) / (a * a / (double(first.n) - 1) + b * b / (double(second.n) - 1));
  return finished(*test, options);
}

Result<TTest> welch_t_test(std::span<const double> first, std::span<const double> second,
                           const TTestOptions& options) {
  return of_values(welch_name, first, second,
                   [&](const Summary& a, const Summary& b) { return welch_t_test(a, b, options); });
}

Result<TTest> one_sample_t_test(const Summary& sample, const TTestOptions& options) {
  TTest test;
  test.name = "Student's t-test, one sample";
  if (auto checked = check_level(options.level, test.name); !checked) return tl::unexpected(checked.error());
  if (auto checked = check_summary(sample, test.name); !checked) return tl::unexpected(checked.error());
  test.n1 = sample.n;
  test.missing = sample.missing;
  test.difference = sample.mean;
  test.standard_error = sample.sd / std::sqrt(double(sample.n));
  test.df = double(sample.n) - 1;
  return finished(std::move(test), options);
}

Result<TTest> one_sample_t_test(std::span<const double> values, const TTestOptions& options) {
  const auto sample = summary(values, "Student's t-test, one sample");
  if (!sample) return tl::unexpected(sample.error());
  return one_sample_t_test(*sample, options);
}

Result<TTest> paired_t_test(std::span<const double> first, std::span<const double> second,
                            const TTestOptions& options) {
  constexpr const char* name = "Student's t-test, paired";
  const auto pairs = complete_pairs(first, second, name);
  if (!pairs) return tl::unexpected(pairs.error());
  auto test = one_sample_t_test(summary_of({pairs->differences, pairs->missing}), options);
  if (!test) return tl::unexpected(with_where(name, test.error()));
  test->name = name;
  test->n2 = test->n1;
  return test;
}

}  // namespace intaglio::statistics
