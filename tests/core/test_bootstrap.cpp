// The bootstrap's interval has the coverage that theory gives, follows its values and is reproducible.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/bootstrap.h"
#include "core/portable_math.h"

using namespace intaglio;

namespace {

std::vector<double> normal_values(Random& random, int count) {
  std::vector<double> values;
  for (int k = 0; k < count; ++k) values.push_back(random.normal());
  return values;
}

}  // namespace

TEST_CASE("an interval of the mean of normal values covers the true mean as often as Student's t says") {
  // P(|t| < 1.96 sqrt((n - 1) / n)) with n - 1 degrees of freedom; by 2000 trials the standard error is 0.006
  // at n = 20 and 0.008 at n = 5.
  const struct {
    int count;
    double coverage, tolerance;
  } cases[] = {{20, 0.9287, 0.024}, {5, 0.8457, 0.032}};
  for (const auto& test : cases) {
    Random random(11);
    int covered = 0;
    const int trials = 2000;
    for (int trial = 0; trial < trials; ++trial) {
      const auto values = normal_values(random, test.count);
      const Interval interval = bootstrap_interval(values, mean, {400, 0.95, random.next()});
      covered += interval.low <= 0 && interval.high >= 0;
    }
    CAPTURE(test.count);
    CHECK(std::abs(double(covered) / trials - test.coverage) < test.tolerance);
  }
}

TEST_CASE("an interval moves and stretches with its values") {
  Random random(3);
  const auto values = normal_values(random, 12);
  std::vector<double> moved;
  for (const double value : values) moved.push_back(4 * value - 7);
  const Interval plain = bootstrap_interval(values), other = bootstrap_interval(moved);
  CHECK(other.low == doctest::Approx(4 * plain.low - 7));
  CHECK(other.high == doctest::Approx(4 * plain.high - 7));
}

TEST_CASE("the same seed gives the same bits and another seed an interval nearby") {
  Random random(5);
  const auto values = normal_values(random, 30);
  const Interval first = bootstrap_interval(values), again = bootstrap_interval(values);
  CHECK(first.low == again.low);
  CHECK(first.high == again.high);
  const Interval other = bootstrap_interval(values, mean, {2000, 0.95, 2});
  CHECK(first.low != other.low);
  CHECK(std::abs(first.low - other.low) < 0.1 * (first.high - first.low));
}

TEST_CASE("an interval of any statistic stays within its values, and a higher level is wider") {
  Random random(6);
  const auto values = normal_values(random, 25);
  const Statistic median = [](std::span<const double> sample) { return quantile(sample, 0.5); };
  const Interval narrow = bootstrap_interval(values, median, {1000, 0.5, 1});
  const Interval wide = bootstrap_interval(values, median, {1000, 0.99, 1});
  CHECK(wide.low < narrow.low);
  CHECK(narrow.high < wide.high);
  CHECK(wide.low >= *std::min_element(values.begin(), values.end()));
  CHECK(wide.high <= *std::max_element(values.begin(), values.end()));
}

TEST_CASE("an interval of one value is that value, and no values give no number") {
  const double one[] = {4.5};
  CHECK(bootstrap_interval(one).low == 4.5);
  CHECK(bootstrap_interval(one).high == 4.5);
  CHECK(std::isnan(bootstrap_interval({}).low));
  CHECK(std::isnan(quantile({}, 0.5)));
}

TEST_CASE("a quantile interpolates between neighbours") {
  const double values[] = {4, 1, 3, 2};
  CHECK(quantile(values, 0) == 1);
  CHECK(quantile(values, 1) == 4);
  CHECK(quantile(values, 0.5) == 2.5);
  CHECK(quantile(values, 0.25) == 1.75);
}
