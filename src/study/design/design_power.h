// The power of a design's hypotheses at a number of participants.
//
// From [analysis] effect by the noncentral t (study/statistics/power.h), or from its rates of right answers
// by simulation: each person's log odds differ from the rate's by a normal deviation, answers are drawn for
// as many trials of each level as the plan has, and persons' shares are compared by the hypothesis' t-test.
// Within a family corrected by Holm or Bonferroni alpha is divided by the number of its hypotheses, the
// strictest step. The simulation is seeded by the design. Cost: about 10 ms a simulated hypothesis.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "intaglio/error.h"
#include "study/design/design.h"

namespace intaglio::study {

struct HypothesisPower {
  std::string hypothesis;
  double alpha = 0.05;          // after the correction
  std::optional<double> power;  // none: `why`
  std::string why;              // how it was found, or why it is not known
};

Result<std::vector<HypothesisPower>> power_of(const Design& design, int participants);

}  // namespace intaglio::study
