// How much of a law a test tries: by default, with INTAGLIO_SLOW=1 in the environment, and under sanitizers.
#pragma once

#include <cstdlib>

namespace intaglio::tests {

// Under sanitizers script/test sets INTAGLIO_SAMPLE: long runs are then cut short. Sanitizers find their
// faults in the first steps; the release tests run all of them. With INTAGLIO_SLOW=1, too, all are run.
inline bool is_sampled() {
  return std::getenv("INTAGLIO_SAMPLE") != nullptr && std::getenv("INTAGLIO_SLOW") == nullptr;
}

// `quick` by default, `slow` with INTAGLIO_SLOW=1 in the environment: sizes, rates.
inline int quick_or_slow(int quick, int slow) {
  return std::getenv("INTAGLIO_SLOW") != nullptr ? slow : quick;
}

// How many random poses a test tries: few by default, `slow` with INTAGLIO_SLOW=1.
inline int poses(int quick, int slow = 100000) {
  return quick_or_slow(quick, slow);
}

}  // namespace intaglio::tests
