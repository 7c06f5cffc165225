// Tests by ranks: Mann-Whitney (two samples) and Wilcoxon's signed ranks (pairs), in named variants.
//
//   exact    the distribution of all orders or signs; ties have their mean rank, and the distribution is
//            that of the ranks as they are tied ("exact, given the ties")
//   normal   z with the variance corrected for ties, and the statistic moved by 1/2 towards its mean
//   chosen   exact without ties and with fewer than 50 values a sample, else normal: the rule of R's
//            wilcox.test, but that pairs without a difference do not exclude the exact variant here
//
// Two-sided p is twice the smaller tail, at most 1. Pairs without a difference are left out of Wilcoxon's
// test and counted (Wilcoxon's own way; Pratt's is not offered); differences within 1e-12 of the greatest
// are ties. All values tie, or no pair differs: not a number and a note. Errors: no value, an infinite
// value, an exact test of more than 200 values. Sources: Wilcoxon 1945; Mann and Whitney 1947; Hollander
// and Wolfe 1999. Any thread; an exact test of 2 × 50 values takes 30 ms.
#pragma once

#include <span>
#include <string>

#include "study/statistics/t_test.h"

namespace intaglio::statistics {

enum class RankVariant { chosen, exact, normal };

struct RankTestOptions {
  Alternative alternative = Alternative::two_sided;
  RankVariant variant = RankVariant::chosen;
};

struct RankTest {
  std::string name, variant;  // "Mann-Whitney", "exact"
  std::size_t n1 = 0, n2 = 0, missing = 0,
              zeros = 0;  // of Wilcoxon's test, n1 counts differences that are not 0
  bool has_ties = false;
  double statistic = 0;  // U of the first sample; W+, the sum of the ranks of positive differences
  double z = 0;          // of the normal variant; else not a number
  double p = 0;
  double rank_biserial = 0;  // -1 to 1: share of pairs (rank sums) that favour the first less the others
  std::string note;
};

Result<RankTest> mann_whitney(std::span<const double> first, std::span<const double> second,
                              const RankTestOptions& options = {});
Result<RankTest> wilcoxon_signed_rank(std::span<const double> first, std::span<const double> second,
                                      const RankTestOptions& options = {});

}  // namespace intaglio::statistics
