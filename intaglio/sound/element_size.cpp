#include "intaglio/sound/element_size.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace intaglio::sound {

double element_size(double volume, double area, const Material& material, const ModeOptions& modes) {
  const double shear_speed = std::sqrt(material.shear_modulus() / material.density);
  const double plate_speed = std::sqrt(material.youngs_modulus / material.density /
                                       (1 - material.poisson_ratio * material.poisson_ratio));
  const double shear = shear_speed / modes.max_frequency;
  const double bending = std::sqrt(1.8 * plate_speed * (2 * volume / area) / modes.max_frequency);
  const double last = std::sqrt(std::numbers::pi * 0.5 * area / modes.count);
  return std::max(std::min(shear, bending), last) / 5;
}

}  // namespace intaglio::sound
