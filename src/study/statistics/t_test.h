// Student's t-tests: one sample, paired, independent with one variance, and Welch's.
//
//   t = difference / standard error
//   one sample   (m - m0) / (s / sqrt(n)), n - 1 degrees of freedom; paired: of the differences
//   Student      s² = ((n1 - 1) s1² + (n2 - 1) s2²) / (n1 + n2 - 2), error s sqrt(1/n1 + 1/n2)
//   Welch        error² = s1²/n1 + s2²/n2; df = error⁴ / ((s1²/n1)²/(n1 - 1) + (s2²/n2)²/(n2 - 1))
//
// Samples or their printed means and deviations. Where no value varies there is no test: t, df of Welch and
// p are not a number, and `note` says so. Errors: fewer than two values, a deviation that is negative or
// infinite. Source: Student 1908; Welch, "The generalization of Student's problem", Biometrika 34, 1947.
// Any thread.
#pragma once

#include <span>
#include <string>

#include "core/bootstrap.h"
#include "study/statistics/sample.h"

namespace intaglio::statistics {

// The hypothesis that is tested against none: of the difference first - second.
enum class Alternative { two_sided, greater, less };

struct TTestOptions {
  Alternative alternative = Alternative::two_sided;
  double level = 0.95;    // of the interval, always two-sided
  double null_value = 0;  // the difference that the null hypothesis names
};

struct TTest {
  std::string name;                         // "Student's t-test, independent"
  std::size_t n1 = 0, n2 = 0, missing = 0;  // n2: 0 for one sample, n1 for pairs; missing values, or pairs
  double difference = 0, standard_error = 0;
  double t = 0, df = 0, p = 0;
  Interval interval;  // of the difference
  std::string note;   // empty, or why there is no number
};

Result<TTest> student_t_test(const Summary& first, const Summary& second, const TTestOptions& options = {});
Result<TTest> student_t_test(std::span<const double> first, std::span<const double> second,
                             const TTestOptions& options = {});
Result<TTest> welch_t_test(const Summary& first, const Summary& second, const TTestOptions& options = {});
Result<TTest> welch_t_test(std::span<const double> first, std::span<const double> second,
                           const TTestOptions& options = {});
// Against the mean `options.null_value`; `difference` is the sample's mean.
Result<TTest> one_sample_t_test(const Summary& sample, const TTestOptions& options = {});
Result<TTest> one_sample_t_test(std::span<const double> values, const TTestOptions& options = {});
Result<TTest> paired_t_test(std::span<const double> first, std::span<const double> second,
                            const TTestOptions& options = {});

// Probability of t or more extreme.
double t_probability(double t, double df, Alternative alternative);

// The deviation of both samples together, weighted by their degrees of freedom.
double pooled_sd(const Summary& first, const Summary& second);

// A sample that a t-test can use: at least two values, a finite deviation. The error says what is wrong.
Result<void> check_summary(const Summary& sample, const std::string& what);

}  // namespace intaglio::statistics
