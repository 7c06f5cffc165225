// What every sense computes, on the same inputs everywhere, as one hash a sense: small scenes that go through
// all that enters an event, a force or a sample. No baker, no window, no picture.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace intaglio::determinism {

struct Outcome {
  std::uint64_t hash = 0;
  std::vector<double> numbers;  // what can be compared with a tolerance where hashes differ
};

struct Sense {
  std::string name;
  std::string about;
  std::function<Outcome()> run;
  bool asks_bullet = false;  // through libbullet, whose own arithmetic it then is
};

std::vector<Sense> senses();

}  // namespace intaglio::determinism
