#include "intaglio/sound/fem/prism.h"

#include <algorithm>

namespace intaglio::sound {

std::array<std::array<int, 4>, 3> prism_tets(std::array<int, 6> p) {
  // Turn the prism until its smallest index is corner 0: about its axis, or upside down first.
  const auto smallest = static_cast<std::size_t>(std::min_element(p.begin(), p.end()) - p.begin());
  if (smallest >= 3) p = {p[3], p[5], p[4], p[0], p[2], p[1]};
  while (p[0] != *std::min_element(p.begin(), p.end())) p = {p[1], p[2], p[0], p[4], p[5], p[3]};
  if (std::min(p[1], p[5]) < std::min(p[2], p[4])) {
    return {{{p[0], p[1], p[2], p[5]}, {p[0], p[1], p[5], p[4]}, {p[0], p[4], p[5], p[3]}}};
  }
  return {{{p[0], p[1], p[2], p[4]}, {p[0], p[4], p[2], p[5]}, {p[0], p[4], p[5], p[3]}}};
}

}  // namespace intaglio::sound
