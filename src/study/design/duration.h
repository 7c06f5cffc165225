// How long a session takes: what a step's `seconds` says, otherwise an estimate, and the longest that the
// limits of time allow.
//
// Estimates: 200 words a minute read aloud or by a careful reader, 8 s a question, 45 s a free text, 40 s a
// trial, and 3 s between screens. They are for planning, not measured.
#pragma once

#include <optional>

#include "study/design/plan.h"

namespace intaglio::study {

struct Duration {
  double expected = 0;            // s
  std::optional<double> longest;  // s; none: a step has no limit
};

Duration duration_of(const Design& design, const PlannedStep& step);
Duration duration_of(const Design& design, const Plan& plan);

}  // namespace intaglio::study
