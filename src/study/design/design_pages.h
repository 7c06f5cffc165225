// A design as text: the answer of `study check`, and a preregistration.
#pragma once

#include <string>

#include "intaglio/error.h"
#include "study/design/design.h"

namespace intaglio::study {

// A session step by step, how long it takes, how orders balance at a number of participants, and the power
// of the hypotheses.
Result<std::string> check_text(const Design& design, int participants, int shown_participant);

// Markdown: hypotheses, sample size, stop rule, exclusions, analysis, and the design's files and hash.
std::string preregistration(const Design& design);

}  // namespace intaglio::study
