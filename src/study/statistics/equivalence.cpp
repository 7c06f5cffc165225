#include "study/statistics/equivalence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace intaglio::statistics {
namespace {

// The test at a difference of `null_value`, by one of the t-tests.
template <class Test>
Result<Equivalence> two_one_sided(double margin, double alpha, const Test& test) {
  constexpr const char* what = "equivalence";
  if (!(margin > 0) || std::isinf(margin))
    return fail(what, fmt::format("the margin is {}", margin), "a margin is greater than 0");
  if (!(alpha > 0 && alpha < 0.5))
    return fail(what, fmt::format("alpha is {}", alpha), "alpha lies between 0 and 0.5, such as 0.05");
  const auto above = test(TTestOptions{Alternative::greater, 1 - 2 * alpha, -margin});
  const auto below = test(TTestOptions{Alternative::less, 1 - 2 * alpha, margin});
  if (!above) return tl::unexpected(above.error());
  if (!below) return tl::unexpected(below.error());
  Equivalence result;
  result.name = above->name;
  result.margin = margin;
  result.difference = above->difference;
  result.df = above->df;
  result.t_low = above->t;
  result.t_high = below->t;
  result.p_low = above->p;
  result.p_high = below->p;
  result.p = std::isnan(above->p) ? above->p : std::max(above->p, below->p);
  result.interval = above->interval;
  result.note = above->note;
  return result;
}

}  // namespace

Result<Equivalence> equivalence(const Summary& first, const Summary& second, double margin, MeansTest test,
                                double alpha) {
  if (test == MeansTest::paired)
    return fail("equivalence", "a paired test needs the pairs, not two means and deviations",
                "give the values");
  return two_one_sided(margin, alpha, [&](const TTestOptions& options) {
    return test == MeansTest::welch ? welch_t_test(first, second, options)
                                    : student_t_test(first, second, options);
  });
}

Result<Equivalence> equivalence(std::span<const double> first, std::span<const double> second, double margin,
                                MeansTest test, double alpha) {
  return two_one_sided(margin, alpha, [&](const TTestOptions& options) {
    if (test == MeansTest::paired) return paired_t_test(first, second, options);
    return test == MeansTest::welch ? welch_t_test(first, second, options)
                                    : student_t_test(first, second, options);
  });
}

}  // namespace intaglio::statistics
