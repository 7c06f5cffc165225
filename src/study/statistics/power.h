// Power of t-tests, and the sample size that a power needs, by the noncentral t.
//
// Independent (Student): noncentrality d sqrt(n1 n2 / (n1 + n2)), n1 + n2 - 2 degrees of freedom, d of
// formula d_pooled. One sample or paired: d_z sqrt(n), n - 1. Two-sided power counts both tails, as R's
// power.t.test(strict = TRUE) does. Source: Cohen 1988. Errors: fewer than two values, an alpha or power
// outside (0, 1), an effect that is not finite or, for a sample size, 0. Any thread; microseconds, sizes
// milliseconds.
#pragma once

#include <cstddef>

#include "intaglio/error.h"
#include "study/statistics/t_test.h"

namespace intaglio::statistics {

struct PowerOptions {
  double alpha = 0.05;
  Alternative alternative = Alternative::two_sided;
};

Result<double> independent_power(double d, std::size_t n1, std::size_t n2, const PowerOptions& options = {});
Result<double> paired_power(double d_z, std::size_t pairs, const PowerOptions& options = {});

// The least number, of values in each group or of pairs, whose power is at least `power`; at most ten
// million.
Result<std::size_t> independent_size(double d, double power, const PowerOptions& options = {});
Result<std::size_t> paired_size(double d_z, double power, const PowerOptions& options = {});

}  // namespace intaglio::statistics
