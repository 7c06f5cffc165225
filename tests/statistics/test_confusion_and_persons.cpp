// Confusion measures, Holm's method and the bootstrap over persons have the values of closed forms, keep
// their laws, and say what is wrong with data that they cannot use.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "study/statistics/confusion.h"
#include "study/statistics/family.h"
#include "study/statistics/person_bootstrap.h"

using namespace intaglio;
using namespace intaglio::statistics;

namespace {

constexpr double absent = std::numeric_limits<double>::quiet_NaN();

}  // namespace

TEST_CASE("perfect answers transmit log2 of the items, and independent ones nothing") {
  const auto perfect = confusion_matrix(4, {5, 0, 0, 0, 0, 5, 0, 0, 0, 0, 5, 0, 0, 0, 0, 5}).value();
  CHECK(information(perfect)->bits == doctest::Approx(2).epsilon(1e-14));
  // Corrections: 3 + 3 - 3 cells beyond the first, over 2 n ln 2.
  CHECK(information(perfect)->miller_madow == doctest::Approx(2 + 3 / (40 * std::log(2.0))).epsilon(1e-14));
  CHECK(rate_correct(perfect) == 1);
  const auto even = confusion_matrix(2, {3, 6, 2, 4}).value();
  CHECK(std::abs(information(even)->bits) < 1e-14);
  CHECK(information(even)->miller_madow == doctest::Approx(-1 / (30 * std::log(2.0))).epsilon(1e-12));
  CHECK_FALSE(information(even)->note.empty());
  CHECK(rate_correct(even) == doctest::Approx(7.0 / 15).epsilon(1e-14));
  CHECK(mean_row_rate(even) == doctest::Approx(0.5).epsilon(1e-14));
}

TEST_CASE(
    "a binary symmetric channel transmits 1 - H(error), and exchanging rows with columns alters nothing") {
  const double e = 0.25, h = -e * std::log2(e) - (1 - e) * std::log2(1 - e);
  CHECK(information(*confusion_matrix(2, {6, 2, 2, 6}))->bits == doctest::Approx(1 - h).epsilon(1e-13));
  const auto matrix = confusion_matrix(3, {7, 1, 2, 0, 5, 3, 4, 1, 6}).value();
  const auto turned = confusion_matrix(3, {7, 0, 4, 1, 5, 1, 2, 3, 6}).value();
  CHECK(information(matrix)->bits == doctest::Approx(information(turned)->bits).epsilon(1e-13));
}

TEST_CASE("errors within families: share, chance and p by hand") {
  // Items 0 and 1 are one family, 2 and 3 the other: a chance of 1/3 in each row; three errors, all within.
  const auto matrix = confusion_matrix(4, {3, 1, 0, 0, 2, 2, 0, 0, 0, 0, 4, 0, 0, 0, 0, 4}).value();
  const auto errors = family_errors(matrix, std::vector<int>{7, 7, 9, 9}).value();
  CHECK(errors.errors == 3);
  CHECK(errors.share == 1);
  CHECK(errors.chance == doctest::Approx(1.0 / 3).epsilon(1e-14));
  CHECK(errors.chance_equal == doctest::Approx(1.0 / 3).epsilon(1e-14));
  CHECK(errors.p == doctest::Approx(1.0 / 27).epsilon(1e-13));
  // Families of 1 and 3: rows have chances of 0 and 2/3; of two errors of row 1, at least one is within.
  const auto uneven = confusion_matrix(4, {0, 1, 0, 0, 1, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1}).value();
  const auto parts = family_errors(uneven, std::vector<int>{0, 1, 1, 1}).value();
  CHECK(parts.p == doctest::Approx(8.0 / 9).epsilon(1e-13));
  CHECK(parts.chance == doctest::Approx(4.0 / 9).epsilon(1e-13));
  CHECK(parts.chance_equal == doctest::Approx(0.5).epsilon(1e-13));
}

TEST_CASE("a matrix without trials, errors or counts gives no number and a note, or an error") {
  const auto empty = confusion_matrix(2, {0, 0, 0, 0}).value();
  CHECK(std::isnan(rate_correct(empty)));
  CHECK(std::isnan(mean_row_rate(empty)));
  CHECK(std::isnan(information(empty)->bits));
  CHECK(std::isnan(family_errors(empty, std::vector<int>{0, 0})->p));
  CHECK(family_errors(empty, std::vector<int>{0, 0})->note == "there are no errors");
  const auto percent = confusion_matrix(2, {62.5, 37.5, 0, 100}).value();
  CHECK_FALSE(information(percent));
  CHECK(std::isnan(family_errors(percent, std::vector<int>{0, 0})->p));
  CHECK(std::isnan(family_errors(*confusion_matrix(2, {0, 1e300, 0, 0}), std::vector<int>{0, 0})->p));
  CHECK_FALSE(confusion_matrix(2, {1, 2, 3}));
  CHECK_FALSE(confusion_matrix(2, {1, -1, 0, 0}));
  CHECK_FALSE(confusion_matrix(2, {1, absent, 0, 0}));
  CHECK_FALSE(confusion_matrix(1, {1}));
  CHECK_FALSE(family_errors(empty, std::vector<int>{0}));
  const std::vector<int> shown = {0, 1, 1, 0}, answered = {0, 0, -1, 1};
  CHECK(confusion_matrix(2, shown, answered)->cells == std::vector<double>{1, 1, 1, 0});
  CHECK_FALSE(confusion_matrix(2, shown, std::vector<int>{0, 0, 2, 1}));
  CHECK_FALSE(confusion_matrix(2, shown, std::vector<int>{0}));
}

TEST_CASE("Holm's p by hand, in any order, and without the tests that have none") {
  const std::vector<double> p = {0.04, 0.01, absent, 0.03, 0.005};
  const auto adjusted = holm(p).value();
  const double expected[] = {0.06, 0.03, absent, 0.06, 0.02};
  for (std::size_t k = 0; k < p.size(); ++k)
    if (k == 2)
      CHECK(std::isnan(adjusted[k]));
    else
      CHECK(adjusted[k] == doctest::Approx(expected[k]).epsilon(1e-14));
  CHECK(*holm(std::vector<double>{0.7, 0.6}) == std::vector<double>{1, 1});
  CHECK(*holm(std::vector<double>{0.2}) == std::vector<double>{0.2});
  CHECK(holm(std::vector<double>{})->empty());
  CHECK_FALSE(holm(std::vector<double>{0.1, 1.5}));
  CHECK_FALSE(holm(std::vector<double>{-0.1}));
}

TEST_CASE("a bootstrap of one seed has one result, and persons who are alike leave no doubt") {
  const std::vector<double> values = {1, 2, 3, 5, 8, 13, 2, 4}, alike = {1, 3, 1, 3, 1, 3, 1, 3};
  const std::vector<int> persons = {4, 4, 9, 9, 1, 1, 0, 0};
  const auto once = bootstrap_mean(values, persons).value(), again = bootstrap_mean(values, persons).value();
  CHECK(once.value == 4.75);
  CHECK(once.persons == 4);
  CHECK(once.interval.low == again.interval.low);
  CHECK(once.interval.high == again.interval.high);
  CHECK(once.interval.low < once.value);
  CHECK(once.interval.high > once.value);
  const auto certain = bootstrap_mean(alike, persons).value();
  CHECK(certain.interval.low == 2);
  CHECK(certain.interval.high == 2);
}

TEST_CASE("two persons of 0 and 1 give draws of 0, 1/2 and 1 by 1 : 2 : 1, and trials add no certainty") {
  int draws[3] = {0, 0, 0};
  BootstrapOptions options;
  options.resamples = 4000;
  const auto half = bootstrap_persons(
                        2,
                        [&](std::span<const std::size_t> persons) {
                          ++draws[persons[0] + persons[1]];
                          return double(persons[0] + persons[1]) / 2;
                        },
                        options)
                        .value();
  CHECK(half.value == 0.5);
  CHECK(half.interval.low == 0);
  CHECK(half.interval.high == 1);
  // Five deviations of a binomial count; the first call is everybody's.
  CHECK(std::abs(draws[1] - 1 - 2000) < 5 * std::sqrt(4000 * 0.25));
  CHECK(std::abs(draws[0] - 1000) < 5 * std::sqrt(4000 * 0.1875));
  CHECK(draws[0] + draws[1] + draws[2] == 4001);
  std::vector<double> trials(200, 0);
  std::vector<int> numbers(200, 0);
  for (std::size_t k = 100; k < 200; ++k) trials[k] = numbers[k] = 1;
  CHECK(bootstrap_mean(trials, numbers)->interval.high == 1);
}

TEST_CASE("one person, nobody, draws without a number and wrong options are said") {
  const std::vector<double> values = {1, 2};
  const auto one = bootstrap_mean(values, std::vector<int>{5, 5}).value();
  CHECK(one.value == 1.5);
  CHECK(std::isnan(one.interval.low));
  CHECK_FALSE(one.note.empty());
  CHECK_FALSE(bootstrap_mean(std::vector<double>{}, std::vector<int>{}));
  CHECK_FALSE(bootstrap_mean(std::vector<double>{absent}, std::vector<int>{1}));
  CHECK_FALSE(bootstrap_mean(values, std::vector<int>{1}));
  CHECK_FALSE(bootstrap_mean(std::vector<double>{1, INFINITY}, std::vector<int>{1, 2}));
  BootstrapOptions wrong;
  wrong.level = 1;
  CHECK_FALSE(bootstrap_mean(values, std::vector<int>{1, 2}, wrong));
  const auto never = bootstrap_persons(3, [](std::span<const std::size_t>) { return absent; }).value();
  CHECK(never.without_number == BootstrapOptions().resamples);
  CHECK(std::isnan(never.interval.low));
  CHECK(std::isnan(never.interval.high));
}
