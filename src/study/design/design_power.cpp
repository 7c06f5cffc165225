#include "study/design/design_power.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/portable_math.h"
#include "study/design/order.h"
#include "study/design/plan.h"
#include "study/statistics/power.h"
#include "study/statistics/t_test.h"

namespace intaglio::study {

namespace {

using Test = Hypothesis::Test;

statistics::Alternative alternative_of(Hypothesis::Direction direction) {
  switch (direction) {
    case Hypothesis::Direction::greater:
      return statistics::Alternative::greater;
    case Hypothesis::Direction::less:
      return statistics::Alternative::less;
    default:
      return statistics::Alternative::two_sided;
  }
}

double corrected_alpha(const Design& design, const Hypothesis& hypothesis) {
  const auto family = std::find_if(design.families.begin(), design.families.end(),
                                   [&](const Family& each) { return each.name == hypothesis.family; });
  if (family == design.families.end()) return 0.05;
  if (family->correction == Family::Correction::none) return family->alpha;
  const auto size = std::count_if(design.hypotheses.begin(), design.hypotheses.end(),
                                  [&](const Hypothesis& each) { return each.family == hypothesis.family; });
  return family->alpha / double(size);
}

// How many trials of each of the two levels a person has.
std::array<int, 2> trials_of(const Design& design, const Hypothesis& hypothesis) {
  std::array<int, 2> counts{};
  const auto made = plan(design, 1);
  if (!made) return counts;
  for (const PlannedStep& step : made->steps)
    for (const PlannedItem& item : step.items)
      for (const std::string& level : item.levels)
        for (std::size_t k = 0; k < 2 && step.trial > 0; ++k)
          if (level == hypothesis.factor + "=" + hypothesis.compare[k]) ++counts[k];
  return counts;
}

double share_right(int trials, double rate, double person, Random& random) {
  const double odds = rate / (1 - rate) * elementary::exp(person);
  int right = 0;
  for (int k = 0; k < trials; ++k) right += random.uniform() < odds / (1 + odds) ? 1 : 0;
  return double(right) / trials;
}

// The share of simulated studies whose paired t-test is significant. Without any difference between persons'
// differences there is no t, and the study counts as not significant.
double simulated_power(const Design& design, const Hypothesis& hypothesis, int participants, double alpha,
                       const std::array<int, 2>& trials, const std::array<double, 2>& rates) {
  constexpr int studies = 4000;
  Random random = random_stream(design.seed, "power/" + hypothesis.name, participants);
  int significant = 0;
  std::vector<double> first(std::size_t(participants), 0), second = first;
  for (int study = 0; study < studies; ++study) {
    for (std::size_t k = 0; k < first.size(); ++k) {
      const double person = design.analysis.person_deviation * random.normal();
      first[k] = share_right(trials[0], rates[0], person, random);
      second[k] = share_right(trials[1], rates[1], person, random);
    }
    const auto test = statistics::paired_t_test(first, second, {alternative_of(hypothesis.direction)});
    significant += test && test->p <= alpha ? 1 : 0;
  }
  return double(significant) / studies;
}

void simulate_power(const Design& design, const Hypothesis& hypothesis, int participants,
                    const std::array<double, 2>& rates, HypothesisPower& found) {
  const auto trials = trials_of(design, hypothesis);
  if (trials[0] == 0 || trials[1] == 0) {
    found.why = "no person has trials of both levels";
    return;
  }
  found.power = simulated_power(design, hypothesis, participants, found.alpha, trials, rates);
  found.why = fmt::format("simulated: rates {:g} and {:g}, {} and {} trials a person", rates[0], rates[1],
                          trials[0], trials[1]);
}

void find_power(const Design& design, const Hypothesis& hypothesis, int participants,
                HypothesisPower& found) {
  const AnalysisPlan& analysis = design.analysis;
  const bool is_paired = hypothesis.test == Test::paired || hypothesis.test == Test::wilcoxon;
  const bool is_independent = hypothesis.test == Test::independent || hypothesis.test == Test::welch ||
                              hypothesis.test == Test::mann_whitney;
  if (hypothesis.measure == "correct" && hypothesis.test == Test::paired && hypothesis.compare.size() == 2) {
    const auto first = analysis.rates.find(hypothesis.compare[0]),
               second = analysis.rates.find(hypothesis.compare[1]);
    if (first != analysis.rates.end() && second != analysis.rates.end())
      return simulate_power(design, hypothesis, participants, {first->second, second->second}, found);
  }
  const auto effect = hypothesis.effect ? hypothesis.effect : analysis.effect;
  if (!effect || (!is_paired && !is_independent)) {
    found.why =
        effect ? "not known for this test: `study simulate` finds it" : "no effect is given in [analysis]";
    return;
  }
  const statistics::PowerOptions options{found.alpha, alternative_of(hypothesis.direction)};
  // The sign of the effect is the direction's: power is for an effect as it is claimed.
  const double d = hypothesis.direction == Hypothesis::Direction::less ? -*effect : *effect;
  const std::size_t n = std::size_t(participants);
  const auto power = is_paired ? statistics::paired_power(d, n, options)
                               : statistics::independent_power(d, n / 2, n - n / 2, options);
  if (!power) {
    found.why = power.error().what;
    return;
  }
  found.power = *power;
  const bool is_rank = hypothesis.test == Test::wilcoxon || hypothesis.test == Test::mann_whitney;
  found.why = fmt::format("d = {:g}, {}{}", *effect, is_paired ? "pairs" : "two halves",
                          is_rank ? ", of the t-test" : "");
}

}  // namespace

Result<std::vector<HypothesisPower>> power_of(const Design& design, int participants) {
  if (participants < 1 || participants > most_participants)
    return fail(design.name, fmt::format("{} participants are out of range", participants), "1 to 10000");
  std::vector<HypothesisPower> all;
  for (const Hypothesis& hypothesis : design.hypotheses) {
    HypothesisPower& found = all.emplace_back();
    found.hypothesis = hypothesis.name;
    found.alpha = corrected_alpha(design, hypothesis);
    find_power(design, hypothesis, participants, found);
  }
  return all;
}

}  // namespace intaglio::study
