// Onsets and trains of impulses in sounds of which their times are known.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "core/portable_math.h"
#include "evaluate/sound_events.h"

namespace intaglio::evaluate {

namespace {

constexpr double sample_rate = 44100;

// Struck modes that ring for some 20 ms.
std::vector<float> struck(const std::vector<double>& times, double seconds, double gain = 1) {
  std::vector<float> out(std::size_t(seconds * sample_rate), 0.f);
  for (const double time : times) {
    const auto from = std::size_t(time * sample_rate);
    for (std::size_t k = from; k < out.size() && k < from + 8000; ++k) {
      const double t = double(k - from) / sample_rate;
      out[k] += float(
          gain * std::exp(-150 * t) *
          (std::sin(2 * std::numbers::pi * 1100 * t) + 0.7 * std::sin(2 * std::numbers::pi * 3700 * t)));
    }
  }
  return out;
}

std::vector<double> train(double first, double apart, double until) {
  std::vector<double> out;
  for (double time = first; time < until; time += apart) out.push_back(time);
  return out;
}

}  // namespace

TEST_CASE("onsets are matched one to one: late, missed and false ones are told apart") {
  const std::vector<double> wanted = {0.1, 0.3, 0.5, 0.7};
  const OnsetMatch same = match_onsets(struck(wanted, 1), struck(wanted, 1, 3), sample_rate);
  CHECK(same.wanted == 4);
  CHECK(same.missed == 0);
  CHECK(same.false_alarms == 0);
  for (const double late : same.late_ms) CHECK(std::abs(late) < 1.1);
  const OnsetMatch other = match_onsets(struck({0.11, 0.31, 0.6, 0.71}, 1), struck(wanted, 1), sample_rate);
  CHECK(other.missed == 1);
  CHECK(other.false_alarms == 1);
  REQUIRE(other.late_ms.size() == 3);
  for (const double late : other.late_ms) CHECK(std::abs(late - 10) < 1.1);
  const OnsetMatch silent = match_onsets(std::vector<float>(44100, 0.f), struck(wanted, 1), sample_rate);
  CHECK(silent.missed == 4);
  CHECK(silent.false_alarms == 0);
}

TEST_CASE("the nearest times are matched first") {
  const OnsetMatch match = match_times(std::vector<double>{0.100, 0.110}, std::vector<double>{0.111});
  REQUIRE(match.late_ms.size() == 1);
  CHECK(match.late_ms[0] == doctest::Approx(-1));
  CHECK(match.false_alarms == 1);
}

TEST_CASE("a train of impulses over a grating comes every wavelength over speed") {
  for (const double apart : {0.004 / 0.2, 0.003 / 0.1}) {
    CAPTURE(apart);
    const std::vector<double> found = impulses(struck(train(0.1, apart, 1.4), 1.5), sample_rate);
    REQUIRE(found.size() > 20);
    CHECK(std::abs(double(found.size()) - 1.3 / apart) < 3);
    CHECK(interval_distance(found, train(0, apart, 1.3)) < 1);
  }
}

TEST_CASE("the distance of two rhythms is the difference of their intervals, and blind to their beginning") {
  CHECK(interval_distance(train(0, 0.012, 1), train(0.003, 0.012, 2)) < 1e-9);
  CHECK(interval_distance(train(0, 0.012, 1), train(0, 0.010, 1)) == doctest::Approx(2));
  // Half of the intervals differ by 4 ms.
  CHECK(interval_distance(std::vector<double>{0, 0.01, 0.024, 0.034, 0.048}, train(0, 0.01, 0.05)) ==
        doctest::Approx(2));
  CHECK(std::isnan(interval_distance(std::vector<double>{0, 1}, train(0, 0.01, 1))));
}

}  // namespace intaglio::evaluate
