// Proportions, m-alternative d' and tests by ranks agree with SciPy on 50 data sets each, and say what is
// wrong with data that they cannot use.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "study/statistics/detectability.h"
#include "study/statistics/distributions.h"
#include "study/statistics/proportion.h"
#include "study/statistics/rank_test.h"
#include "tests/statistics/fixture.h"

using namespace intaglio;
using namespace intaglio::statistics;
using namespace intaglio::tests;

namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

struct Side {
  const char* name;
  Alternative alternative;
};

constexpr Side sides[] = {
    {"two-sided", Alternative::two_sided}, {"greater", Alternative::greater}, {"less", Alternative::less}};

void check_rank_tests(const FixtureRow& row, const Side& side) {
  const auto &x = row.list("x"), &y = row.list("y");
  const std::size_t count = std::min(x.size(), y.size());
  const std::vector<double> first(x.begin(), x.begin() + std::ptrdiff_t(count));
  const std::vector<double> second(y.begin(), y.begin() + std::ptrdiff_t(count));
  const RankTestOptions exact = {side.alternative, RankVariant::exact};
  const RankTestOptions normal = {side.alternative, RankVariant::normal};
  const std::string name = side.name;
  CHECK(agrees(mann_whitney(x, y, exact)->p, row.number("mw_" + name)));
  CHECK(agrees(mann_whitney(x, y, normal)->p, row.number("mw_normal_" + name)));
  CHECK(agrees(wilcoxon_signed_rank(first, second, exact)->p, row.number("sr_" + name)));
  CHECK(agrees(wilcoxon_signed_rank(first, second, normal)->p, row.number("sr_normal_" + name)));
  CHECK(mann_whitney(x, y, exact)->statistic == row.number("u"));
  CHECK(wilcoxon_signed_rank(first, second, exact)->statistic == row.number("w"));
}

}  // namespace

TEST_CASE("exact intervals, binomial tests and Fisher's test agree with SciPy on 50 data sets") {
  const auto rows = read_fixture("rates.tsv");
  REQUIRE(rows.size() == 50);
  for (const FixtureRow& row : rows) {
    const auto k1 = std::size_t(row.integer("k1")), n1 = std::size_t(row.integer("n1"));
    const auto k2 = std::size_t(row.integer("k2")), n2 = std::size_t(row.integer("n2"));
    CAPTURE(k1);
    CAPTURE(n1);
    const auto exact = clopper_pearson(k1, n1, row.number("level")).value();
    CHECK(agrees(exact.interval.low, row.number("low")));
    CHECK(agrees(exact.interval.high, row.number("high")));
    const auto score = wilson(k1, n1, row.number("level")).value();
    CHECK(agrees(score.interval.low, row.number("wilson_low")));
    CHECK(agrees(score.interval.high, row.number("wilson_high")));
    const auto test = binomial_test(k1, n1, row.number("chance")).value();
    CHECK(agrees(test.p_two_sided, row.number("two")));
    CHECK(agrees(test.p_greater, row.number("greater")));
    CHECK(agrees(test.p_less, row.number("less")));
    const auto two = two_proportions(k1, n1, k2, n2).value();
    CHECK(agrees(two.fisher, row.number("fisher")));
    CHECK(agrees(two.fisher_greater, row.number("fisher_greater")));
    CHECK(agrees(two.p_pooled, row.number("p_pooled")));
    CHECK(agrees(two.p_unpooled, row.number("p_unpooled")));
  }
}

TEST_CASE("Mann-Whitney and Wilcoxon agree with SciPy on 50 data sets, exact, normal and with ties") {
  const auto rows = read_fixture("ranks.tsv");
  REQUIRE(rows.size() == 50);
  for (const FixtureRow& row : rows)
    for (const Side& side : sides) check_rank_tests(row, side);
}

TEST_CASE("the rate of a d' agrees with SciPy's quadrature on 50 data sets, and d' with the rate") {
  const auto rows = read_fixture("choices.tsv");
  REQUIRE(rows.size() == 50);
  for (const FixtureRow& row : rows) {
    const int m = row.integer("m");
    CHECK(agrees(choice_rate(row.number("d"), m), row.number("rate"), 1e-12));
    CHECK(agrees(detectability(row.number("rate"), m).value(), row.number("d")));
  }
  // With two alternatives, the rate is Φ(d' / √2); without signal, any number is at chance.
  for (const double d : {-2.0, 0.3, 1.0, 3.5})
    CHECK(agrees(choice_rate(d, 2), normal_cdf(d / std::sqrt(2.0)), 1e-13));
  for (const int m : {2, 3, 10, 40}) CHECK(agrees(choice_rate(0, m), 1.0 / m, 1e-13));
}

TEST_CASE("rates of 0 and 1 have an infinite d' and one finite end") {
  const auto all = detectability(clopper_pearson(12, 12).value(), 10).value();
  CHECK(std::isinf(all.d_prime));
  CHECK(std::isinf(all.interval.high));
  CHECK(all.interval.low == doctest::Approx(*detectability(std::pow(0.025, 1.0 / 12), 10)).epsilon(1e-9));
  const auto none = detectability(clopper_pearson(0, 12).value(), 10).value();
  CHECK(none.d_prime == -std::numeric_limits<double>::infinity());
  CHECK(std::isfinite(none.interval.high));
}

TEST_CASE("counts, rates, chances and levels that cannot be are errors") {
  CHECK(clopper_pearson(0, 0).error().message().find("no trials") != std::string::npos);
  CHECK(wilson(3, 2).error().message().find("3 of 2") != std::string::npos);
  CHECK_FALSE(clopper_pearson(1, 2, 1));
  CHECK_FALSE(clopper_pearson(1, 2, no_value));
  CHECK_FALSE(binomial_test(1, 2, 0));
  CHECK_FALSE(two_proportions(1, 2, 0, 0));
  CHECK_FALSE(detectability(1.5, 3));
  CHECK_FALSE(detectability(no_value, 3));
  CHECK_FALSE(detectability(0.5, 1));
  const auto extreme = two_proportions(2, 2, 2, 2).value();
  CHECK(std::isnan(extreme.z_pooled));
  CHECK(extreme.fisher == doctest::Approx(1));
  CHECK_FALSE(extreme.note.empty());
}

TEST_CASE("values that all tie, pairs that do not differ and missing values: no crash, and a note") {
  const std::vector<double> same = {3, 3}, none = {no_value, no_value}, shifted = {5, 5};
  for (const RankVariant variant : {RankVariant::chosen, RankVariant::exact, RankVariant::normal}) {
    const auto tie = mann_whitney(same, same, {Alternative::two_sided, variant}).value();
    CHECK(std::isnan(tie.p));
    CHECK(tie.note.find("all values tie") != std::string::npos);
    const auto zero = wilcoxon_signed_rank(same, same, {Alternative::two_sided, variant}).value();
    CHECK(std::isnan(zero.p));
    CHECK(zero.zeros == 2);
    CHECK(zero.note.find("no pair differs") != std::string::npos);
  }
  // Two equal differences of one sign: a quarter of the signs are so, on one side.
  CHECK(wilcoxon_signed_rank(shifted, same, {Alternative::greater, RankVariant::exact})->p == 0.25);
  CHECK(mann_whitney(shifted, same, {Alternative::two_sided, RankVariant::exact})->p ==
        doctest::Approx(1.0 / 3).epsilon(1e-12));
  CHECK(mann_whitney(none, same).error().message().find("missing") != std::string::npos);
  CHECK_FALSE(wilcoxon_signed_rank(none, same));
  CHECK_FALSE(wilcoxon_signed_rank(same, std::vector<double>{1, 2, 3}));
  const std::vector<double> part = {1, no_value, 4, 9}, others = {2, 7, 3, 5};
  CHECK(wilcoxon_signed_rank(part, others)->missing == 1);
  CHECK(mann_whitney(part, others)->n1 == 3);
  const std::vector<double> low = {1, 2, 3}, high = {4, 5, 6};
  CHECK(mann_whitney(low, high)->variant == "exact");
  CHECK(mann_whitney(low, high)->p == doctest::Approx(0.1).epsilon(1e-13));
  CHECK(mann_whitney(low, high)->rank_biserial == -1);
  CHECK(mann_whitney(low, low)->variant.find("normal") == 0);
  const std::vector<double> many(150, 1), more(150, 2);
  CHECK_FALSE(mann_whitney(many, more, {Alternative::two_sided, RankVariant::exact}));
  CHECK(wilcoxon_signed_rank(std::vector<double>{0.3, 0.4}, std::vector<double>{0.1, 0.2})->has_ties);
}
