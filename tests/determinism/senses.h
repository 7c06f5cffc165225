// Results of every sense for the same inputs everywhere, as one hash a sense: small scenes that exercise
// everything that enters an event, a force or a sample. No baker, no window, no picture.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace intaglio::determinism {

struct Outcome {
  std::uint64_t hash = 0;
  std::vector<double> numbers;  // for comparison with a tolerance where hashes differ
};

struct Sense {
  std::string name;
  std::string about;
  std::function<Outcome()> run;
  bool asks_bullet = false;  // uses libbullet's own arithmetic
};

std::vector<Sense> senses();

}  // namespace intaglio::determinism
