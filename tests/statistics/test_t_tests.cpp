// t-tests, effect sizes, equivalence and power agree with SciPy on 50 data sets, obey their laws, and say
// what is wrong with data that they cannot use.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "study/statistics/distributions.h"
#include "study/statistics/effect_size.h"
#include "study/statistics/equivalence.h"
#include "study/statistics/power.h"
#include "study/statistics/t_test.h"
#include "tests/statistics/fixture.h"

using namespace intaglio;
using namespace intaglio::statistics;
using namespace intaglio::tests;

namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

void check_paired(const FixtureRow& row, double level) {
  std::vector<double> x = row.list("x"), y = row.list("y");
  const std::size_t count = std::min(x.size(), y.size());
  x.resize(count);
  y.resize(count);
  const auto test = paired_t_test(x, y).value();
  CHECK(agrees(test.t, row.number("paired_t")));
  CHECK(agrees(test.p, row.number("paired_p")));
  CHECK(agrees(paired_t_test(x, y, {Alternative::less, 0.95, 0})->p, row.number("paired_less")));
  CHECK(agrees(equivalence(x, y, 0.5, MeansTest::paired)->p, row.number("paired_tost")));
  const auto z = d_z(x, y, level).value();
  CHECK(agrees(z.d, row.number("d_z")));
  CHECK(agrees(z.interval.low, row.number("z_low")));
  CHECK(agrees(z.interval.high, row.number("z_high")));
  CHECK(agrees(z.g, row.number("g_z")));
  const auto average = paired_d_av(x, y, level).value();
  CHECK(agrees(average.d, row.number("paired_d_av")));
  CHECK(agrees(average.interval.low, row.number("av_low")));
  // Two pairs are correlated by 1 or -1, where d_rm is the difference of rounding errors.
  if (count > 2) CHECK(agrees(d_rm(x, y)->d, row.number("d_rm")));
}

}  // namespace

TEST_CASE("t-tests, effect sizes and their intervals agree with SciPy on 50 data sets") {
  const auto rows = read_fixture("t_tests.tsv");
  REQUIRE(rows.size() == 50);
  for (const FixtureRow& row : rows) {
    const auto &x = row.list("x"), &y = row.list("y");
    const double level = row.number("level");
    const Summary a = summary(x).value(), b = summary(y).value();
    CHECK(agrees(a.mean, row.number("mean")));
    CHECK(agrees(a.sd, row.number("sd")));
    const auto test = student_t_test(x, y, {Alternative::two_sided, level, 0}).value();
    CHECK(agrees(test.t, row.number("t")));
    CHECK(agrees(test.p, row.number("p")));
    CHECK(agrees(test.interval.low, row.number("low")));
    CHECK(agrees(test.interval.high, row.number("high")));
    CHECK(agrees(student_t_test(x, y, {Alternative::greater, level, 0})->p, row.number("p_greater")));
    const auto welch = welch_t_test(x, y).value();
    CHECK(agrees(welch.t, row.number("welch_t")));
    CHECK(agrees(welch.p, row.number("welch_p")));
    CHECK(agrees(welch.df, row.number("welch_df")));
    CHECK(agrees(equivalence(a, b, 0.5, MeansTest::student)->p, row.number("tost")));
    CHECK(agrees(equivalence(x, y, 0.5)->p, row.number("welch_tost")));
    const auto d = d_pooled(a, b, level).value();
    CHECK(agrees(d.d, row.number("d_pooled")));
    CHECK(agrees(d.interval.low, row.number("d_low")));
    CHECK(agrees(d.interval.high, row.number("d_high")));
    CHECK(agrees(d.g, row.number("g")));
    CHECK(agrees(d_av(a, b)->d, row.number("d_av")));
    CHECK(agrees(glass_delta(a, b)->d, row.number("glass")));
    check_paired(row, level);
  }
}

TEST_CASE("missing values are left out and counted, and a pair with one is left out whole") {
  const std::vector<double> x = {3, missing, 5, 8, 4}, y = {1, 2, missing, 6, 1};
  const auto test = student_t_test(x, y).value();
  CHECK(test.missing == 2);
  CHECK(test.n1 == 4);
  const std::vector<double> first = {3, 8, 4}, second = {1, 6, 1};
  const auto paired = paired_t_test(x, y).value();
  CHECK(paired.missing == 2);
  CHECK(paired.t == paired_t_test(first, second)->t);
  CHECK(d_z(x, y)->d == d_z(first, second)->d);
}

TEST_CASE("values that do not vary have no t and no d, and a note says so") {
  const std::vector<double> same = {0.1, 0.1, 0.1}, other = {0.3, 0.3, 0.3}, shifted = {1.1, 1.1, 1.1};
  for (const auto& test :
       {student_t_test(same, other), welch_t_test(same, same), paired_t_test(same, shifted)}) {
    REQUIRE(test);
    CHECK(std::isnan(test->t));
    CHECK(std::isnan(test->p));
    CHECK(test->note.find("no value varies") != std::string::npos);
  }
  CHECK(std::isnan(d_pooled(*summary(same), *summary(other))->d));
  CHECK(std::isnan(d_z(same, shifted)->d));
  CHECK(std::isnan(equivalence(same, other, 1)->p));
  // One of both varies: the test has a number.
  CHECK(std::isfinite(student_t_test(same, std::vector<double>{1, 2, 4})->t));
  CHECK(std::isnan(d_rm(same, std::vector<double>{1, 2, 4})->d));
}

TEST_CASE("too few values, infinite ones and wrong levels are errors that say what would be right") {
  const std::vector<double> one = {1}, two = {1, 2}, none = {missing, missing},
                            infinite = {1, std::numeric_limits<double>::infinity()};
  CHECK(student_t_test(one, two).error().message().find("at least two") != std::string::npos);
  CHECK(student_t_test(none, two).error().message().find("2 are missing") != std::string::npos);
  CHECK(welch_t_test(two, infinite).error().message().find("infinite") != std::string::npos);
  CHECK(paired_t_test(one, two).error().message().find("1 first and 2 second") != std::string::npos);
  CHECK_FALSE(student_t_test(two, two, {Alternative::two_sided, 1, 0}));
  CHECK_FALSE(student_t_test(printed(1, -1, 5), printed(1, 1, 5)));
  CHECK_FALSE(equivalence(two, two, -1));
  CHECK_FALSE(equivalence(printed(1, 1, 5), printed(1, 1, 5), 1, MeansTest::paired));
  CHECK_FALSE(d_pooled(printed(1, 1, 1), printed(1, 1, 5)));
  CHECK_FALSE(independent_power(0.5, 1, 10));
  CHECK_FALSE(independent_size(0, 0.8));
  CHECK_FALSE(independent_size(1e-9, 0.8));
}

TEST_CASE("the ends of an effect's interval are the effects at which the observed t is a quantile") {
  const auto d = d_pooled(printed(7.9, 1.3, 12), printed(4.9, 2.2, 9), 0.9).value();
  const auto test = student_t_test(printed(7.9, 1.3, 12), printed(4.9, 2.2, 9)).value();
  const double scale = std::sqrt(12.0 * 9 / 21);
  CHECK(noncentral_t_cdf(test.t, test.df, d.interval.low * scale) == doctest::Approx(0.95).epsilon(1e-10));
  CHECK(noncentral_t_cdf(test.t, test.df, d.interval.high * scale) == doctest::Approx(0.05).epsilon(1e-10));
}

TEST_CASE("power without an effect is alpha, and a sample size is the least that has the power") {
  CHECK(*independent_power(0, 9, 20) == doctest::Approx(0.05).epsilon(1e-12));
  CHECK(*paired_power(0, 7, {0.01, Alternative::greater}) == doctest::Approx(0.01).epsilon(1e-12));
  for (const double d : {0.2, -0.5, 1.3, 4.0}) {
    const std::size_t n = independent_size(d, 0.8).value(), pairs = paired_size(d, 0.9).value();
    CHECK(*independent_power(d, n, n) >= 0.8);
    if (n > 2) CHECK(*independent_power(d, n - 1, n - 1) < 0.8);
    CHECK(*paired_power(d, pairs) >= 0.9);
    if (pairs > 2) CHECK(*paired_power(d, pairs - 1) < 0.9);
  }
}
