// Equivalence of two means by two one-sided tests (TOST): what a claim of "no difference" needs.
//
// The null hypothesis is a difference of `margin` or more. p is the greater of the two one-sided p: against
// a difference of at most -margin, and of at least margin. Equivalent at alpha where p < alpha, which is
// where the interval of level 1 - 2 alpha lies between the margins. The margin is in the values' unit, and
// must be chosen before the data are seen. Source: Schuirmann, "A comparison of the two one-sided tests
// procedure", 1987. Errors and notes: as of a t-test; a margin that is not positive is an error. Any
// thread.
#pragma once

#include <span>
#include <string>

#include "core/bootstrap.h"
#include "study/statistics/t_test.h"

namespace intaglio::statistics {

struct Equivalence {
  std::string name;  // of the t-test
  double margin = 0, difference = 0, df = 0;
  double t_low = 0, t_high = 0;  // of the difference + margin and - margin
  double p_low = 0, p_high = 0, p = 0;
  Interval interval;  // of level 1 - 2 alpha
  std::string note;
};

enum class MeansTest { student, welch, paired };

Result<Equivalence> equivalence(const Summary& first, const Summary& second, double margin,
                                MeansTest test = MeansTest::welch, double alpha = 0.05);
Result<Equivalence> equivalence(std::span<const double> first, std::span<const double> second, double margin,
                                MeansTest test = MeansTest::welch, double alpha = 0.05);

}  // namespace intaglio::statistics
