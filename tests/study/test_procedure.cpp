// Adaptive procedures: QUEST+ against a brute-force grid, and both against observers of known threshold.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "core/portable_math.h"
#include "study/design/procedure.h"

using namespace intaglio;
using namespace intaglio::study;

namespace {

// QUEST+ as it is defined: for each amount both posteriors by Bayes' rule, their entropies, and the mean of
// these by the answers' probabilities.
class BruteQuest {
 public:
  explicit BruteQuest(const Adaptive& adaptive) : adaptive_(adaptive) {
    for (const double threshold : quest_thresholds(adaptive))
      for (const double slope : quest_slopes(adaptive)) parameters_.push_back({threshold, slope, 1.0});
    for (Point& point : parameters_) point.p = 1.0 / double(parameters_.size());
  }

  double expected_entropy(double amount) const {
    double expected = 0;
    for (const bool is_noticed : {false, true}) {
      const auto [after, probability] = posterior(amount, is_noticed);
      double entropy = 0;
      for (const Point& point : after)
        if (point.p > 0) entropy -= point.p * std::log(point.p);
      expected += probability * entropy;
    }
    return expected;
  }

  void answer(double amount, bool is_noticed) { parameters_ = posterior(amount, is_noticed).first; }

  double mean_threshold() const {
    double mean = 0;
    for (const Point& point : parameters_) mean += point.p * point.threshold;
    return mean;
  }

 private:
  struct Point {
    double threshold, slope, p;
  };
  std::pair<std::vector<Point>, double> posterior(double amount, bool is_noticed) const {
    std::vector<Point> after = parameters_;
    double total = 0;
    for (Point& point : after) {
      const double noticed =
          adaptive_.guess + (1 - adaptive_.guess - adaptive_.lapse) *
                                (1 - std::exp(-std::pow(amount / point.threshold, point.slope)));
      point.p *= is_noticed ? noticed : 1 - noticed;
      total += point.p;
    }
    for (Point& point : after) point.p /= total;
    return {after, total};
  }

  Adaptive adaptive_;
  std::vector<Point> parameters_;
};

Adaptive quest_settings() {
  Adaptive adaptive;
  adaptive.method = Adaptive::Method::quest;
  adaptive.low = 0, adaptive.high = 0.3, adaptive.grid = 31;
  return adaptive;
}

}  // namespace

TEST_CASE("QUEST+ presents the amount of least expected entropy, as a brute-force grid finds it") {
  const Adaptive adaptive = quest_settings();
  const auto amounts = quest_amounts(adaptive);
  for (const std::uint64_t seed : {1, 2, 3}) {
    Random random(seed);
    const auto quest = make_procedure(adaptive);
    BruteQuest brute(adaptive);
    for (int trial = 0; trial < 25; ++trial) {
      double least = 1e9;
      for (const double amount : amounts) least = std::min(least, brute.expected_entropy(amount));
      // Amounts whose entropies differ by rounding only are as good.
      CHECK(brute.expected_entropy(quest->amount()) <= least + 1e-11);
      const bool is_noticed = random.uniform() < weibull(quest->amount(), 0.08, 3, 0.02, 0.02);
      brute.answer(quest->amount(), is_noticed);
      quest->answer(is_noticed);
      CHECK(quest->estimate().threshold == doctest::Approx(brute.mean_threshold()).epsilon(1e-10));
    }
  }
}

TEST_CASE("QUEST+ finds an observer's threshold, and its deviation is that of its errors") {
  const Adaptive adaptive = quest_settings();
  constexpr double threshold = 0.1;
  double sum = 0, squares = 0, claimed = 0;
  constexpr int observers = 60;
  for (int observer = 0; observer < observers; ++observer) {
    Random random(std::uint64_t(observer) + 100);
    const auto quest = make_procedure(adaptive);
    for (int trial = 0; trial < 60; ++trial) {
      const double p = weibull(quest->amount(), threshold, 3, adaptive.guess, adaptive.lapse);
      quest->answer(random.uniform() < p);
    }
    const double error = quest->estimate().threshold - threshold;
    sum += error;
    squares += error * error;
    claimed += quest->estimate().deviation / observers;
  }
  const double rms = std::sqrt(squares / observers);
  CAPTURE(rms);
  CAPTURE(claimed);
  CHECK(std::abs(sum / observers) < 0.005);
  CHECK(rms < 0.012);
  CHECK(rms > 0.5 * claimed);
  CHECK(rms < 2 * claimed);
}

TEST_CASE("a staircase of two down and one up converges to 70.7 % noticed") {
  Adaptive adaptive;
  adaptive.low = 0, adaptive.high = 1, adaptive.start = 0.8, adaptive.step = 0.2;
  adaptive.smallest_step = 0.01, adaptive.reversals = 60, adaptive.down = 2, adaptive.up = 1;
  constexpr double threshold = 0.4, slope = 3;
  const double expected = threshold * std::pow(-std::log(1 - std::sqrt(0.5)), 1 / slope);
  double mean = 0;
  constexpr int observers = 200;
  for (int observer = 0; observer < observers; ++observer) {
    Random random(std::uint64_t{1} * unsigned(observer));
    const auto staircase = make_procedure(adaptive);
    int trials = 0;
    while (!staircase->is_done() && ++trials < 2000)
      staircase->answer(random.uniform() < weibull(staircase->amount(), threshold, slope, 0, 0));
    CHECK(staircase->is_done());
    CHECK(staircase->estimate().answers == trials);
    mean += staircase->estimate().threshold / observers;
  }
  CHECK(mean == doctest::Approx(expected).epsilon(0.02));
}

TEST_CASE("amounts stay in range, and a procedure that is given its answers again is where it was") {
  for (const auto method : {Adaptive::Method::staircase, Adaptive::Method::quest}) {
    Adaptive adaptive;
    adaptive.method = method;
    adaptive.low = 0.1, adaptive.high = 0.6, adaptive.start = 0.3, adaptive.step = 0.2, adaptive.grid = 21;
    for (const bool always : {false, true}) {
      const auto one = make_procedure(adaptive);
      for (int k = 0; k < 40; ++k) {
        CHECK(one->amount() >= adaptive.low);
        CHECK(one->amount() <= adaptive.high);
        one->answer(always);
      }
    }
    const auto one = make_procedure(adaptive), two = make_procedure(adaptive);
    Random random(5);
    std::vector<bool> answers;
    for (int k = 0; k < 30; ++k) {
      answers.push_back(random.uniform() < 0.5);
      one->answer(answers.back());
    }
    for (const bool each : answers) two->answer(each);
    CHECK(one->amount() == two->amount());
    CHECK(one->estimate().threshold == two->estimate().threshold);
  }
}

TEST_CASE("answers that the model forbids neither stop QUEST+ nor make it say nonsense") {
  Adaptive adaptive = quest_settings();
  adaptive.guess = 0, adaptive.lapse = 0, adaptive.precision = 0.01;
  const auto quest = make_procedure(adaptive);
  for (int k = 0; k < 200; ++k) quest->answer(quest->amount() == 0);
  CHECK(std::isfinite(quest->estimate().threshold));
  CHECK(std::isfinite(quest->estimate().deviation));
}
