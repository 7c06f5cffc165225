// Measures of sound, for the tests of sound.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

namespace intaglio::sound::test {

inline double rms(std::span<const float> samples) {
  double sum = 0;
  for (const float x : samples) sum += double(x) * x;
  return std::sqrt(sum / double(samples.size()));
}

inline bool all_zero(std::span<const float> samples) {
  return std::all_of(samples.begin(), samples.end(), [](float x) { return x == 0; });
}

}  // namespace intaglio::sound::test
