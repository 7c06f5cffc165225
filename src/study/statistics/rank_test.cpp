#include "study/statistics/rank_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "study/statistics/distributions.h"

namespace intaglio::statistics {
namespace {

struct Ranks {
  std::vector<std::size_t> twice;  // twice the rank: whole, for mean ranks too
  double ties = 0;                 // Σ t³ - t over groups of t equal values
};

// Values closer than `apart` to the least of their group are equal.
Ranks ranks_of(const std::vector<double>& values, double apart) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  Ranks ranks;
  ranks.twice.resize(values.size());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t end = first + 1;
    while (end < order.size() && values[order[end]] - values[order[first]] <= apart) ++end;
    for (std::size_t k = first; k < end; ++k) ranks.twice[order[k]] = first + 1 + end;
    const double tied = double(end - first);
    ranks.ties += tied * tied * tied - tied;
    first = end;
  }
  return ranks;
}

// How many subsets of the ranks have a sum (twice): all subsets, or those of one size. Counts are doubles:
// exact up to 2^53, and within rounding beyond.
std::vector<double> sums_of_all(const std::vector<std::size_t>& ranks) {
  std::vector<double> ways(std::accumulate(ranks.begin(), ranks.end(), std::size_t{1}), 0);
  ways[0] = 1;
  for (const std::size_t rank : ranks)
    for (std::size_t sum = ways.size(); sum-- > rank;) ways[sum] += ways[sum - rank];
  return ways;
}

std::vector<double> sums_of_size(const std::vector<std::size_t>& ranks, std::size_t size) {
  const std::size_t most = std::accumulate(ranks.begin(), ranks.end(), std::size_t{1});
  std::vector<std::vector<double>> ways(size + 1, std::vector<double>(most, 0));
  ways[0][0] = 1;
  for (const std::size_t rank : ranks)
    for (std::size_t count = size; count-- > 0;)
      for (std::size_t sum = most; sum-- > rank;) ways[count + 1][sum] += ways[count][sum - rank];
  return ways[size];
}

double exact_probability(const std::vector<double>& ways, std::size_t observed, Alternative alternative) {
  const double all = std::accumulate(ways.begin(), ways.end(), 0.0);
  const auto at = ways.begin() + std::ptrdiff_t(observed);
  const double less = std::accumulate(ways.begin(), at + 1, 0.0) / all;
  const double greater = std::accumulate(at, ways.end(), 0.0) / all;
  if (alternative == Alternative::greater) return greater;
  return alternative == Alternative::less ? less : std::min(1.0, 2 * std::min(less, greater));
}

// Fills in z and p of the normal variant.
void normal_probability(RankTest& test, double mean, double variance, Alternative alternative) {
  double excess = test.statistic - mean;
  switch (alternative) {
    case Alternative::greater:
      excess -= 0.5;
      break;
    case Alternative::less:
      excess += 0.5;
      break;
    case Alternative::two_sided:
      excess -= excess > 0 ? 0.5 : excess < 0 ? -0.5 : 0;
      break;
  }
  test.z = excess / std::sqrt(variance);
  if (alternative == Alternative::greater) test.p = normal_upper(test.z);
  if (alternative == Alternative::less) test.p = normal_cdf(test.z);
  if (alternative == Alternative::two_sided) test.p = std::min(1.0, 2 * normal_upper(std::abs(test.z)));
}

// Whether the exact variant is used; its name goes to the test.
Result<bool> is_exact(RankTest& test, RankVariant variant) {
  if (variant == RankVariant::exact && test.n1 + test.n2 > 200)
    return fail(test.name, fmt::format("an exact test of {} values takes too long", test.n1 + test.n2),
                "ask for the normal variant");
  const bool exact = variant == RankVariant::exact ||
                     (variant == RankVariant::chosen && !test.has_ties && std::max(test.n1, test.n2) < 50);
  test.variant = !exact          ? "normal, corrected for ties and continuity"
                 : test.has_ties ? "exact, given the ties"
                                 : "exact";
  return exact;
}

}  // namespace

Result<RankTest> mann_whitney(std::span<const double> first, std::span<const double> second,
                              const RankTestOptions& options) {
  RankTest test;
  test.name = "Mann-Whitney";
  const auto a = observed(first, test.name), b = observed(second, test.name);
  if (!a) return tl::unexpected(a.error());
  if (!b) return tl::unexpected(b.error());
  test.n1 = a->values.size();
  test.n2 = b->values.size();
  test.missing = a->missing + b->missing;
  std::vector<double> both = a->values;
  both.insert(both.end(), b->values.begin(), b->values.end());
  const Ranks ranks = ranks_of(both, 0);
  test.has_ties = ranks.ties > 0;
  const double n1 = double(test.n1), n2 = double(test.n2), n = n1 + n2;
  const std::size_t sum =
      std::accumulate(ranks.twice.begin(), ranks.twice.begin() + std::ptrdiff_t(test.n1), std::size_t{0});
  test.statistic = double(sum) / 2 - n1 * (n1 + 1) / 2;
  test.z = undefined;
  test.rank_biserial = 2 * test.statistic / (n1 * n2) - 1;
  if (ranks.ties == n * n * n - n) {
    test.variant = "none";
    test.p = undefined;
    test.note = "all values tie: there is no rank test";
    return test;
  }
  const auto exact = is_exact(test, options.variant);
  if (!exact) return tl::unexpected(exact.error());
  if (*exact)
    test.p = exact_probability(sums_of_size(ranks.twice, test.n1), sum, options.alternative);
  else
    normal_probability(test, n1 * n2 / 2, n1 * n2 / 12 * (n + 1 - ranks.ties / (n * (n - 1))),
                       options.alternative);
  return test;
}

Result<RankTest> wilcoxon_signed_rank(std::span<const double> first, std::span<const double> second,
                                      const RankTestOptions& options) {
  RankTest test;
  test.name = "Wilcoxon's signed ranks";
  const auto pairs = complete_pairs(first, second, test.name);
  if (!pairs) return tl::unexpected(pairs.error());
  double greatest = 0;
  for (const double difference : pairs->differences) greatest = std::max(greatest, std::abs(difference));
  // Decimal values have differences that rounding sets apart.
  const double apart = 1e-12 * greatest;
  std::vector<double> sizes;
  std::vector<bool> positive;
  for (const double difference : pairs->differences) {
    if (std::abs(difference) <= apart) continue;
    sizes.push_back(std::abs(difference));
    positive.push_back(difference > 0);
  }
  test.n1 = sizes.size();
  test.missing = pairs->missing;
  test.zeros = pairs->differences.size() - sizes.size();
  test.z = undefined;
  if (sizes.empty()) {
    test.variant = "none";
    test.p = test.rank_biserial = undefined;
    test.note = "no pair differs: there is no rank test";
    return test;
  }
  const Ranks ranks = ranks_of(sizes, apart);
  test.has_ties = ranks.ties > 0;
  std::size_t sum = 0;
  for (std::size_t k = 0; k < sizes.size(); ++k) sum += positive[k] ? ranks.twice[k] : 0;
  const double n = double(test.n1), all = n * (n + 1) / 2;
  test.statistic = double(sum) / 2;
  test.rank_biserial = 2 * test.statistic / all - 1;
  const auto exact = is_exact(test, options.variant);
  if (!exact) return tl::unexpected(exact.error());
  if (*exact)
    test.p = exact_probability(sums_of_all(ranks.twice), sum, options.alternative);
  else
    normal_probability(test, all / 2, n * (n + 1) * (2 * n + 1) / 24 - ranks.ties / 48, options.alternative);
  return test;
}

}  // namespace intaglio::statistics
