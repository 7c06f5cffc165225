#include "intaglio/sound/element_size.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace intaglio::sound {

double element_size(double volume, double area, const Material& material, const ModeOptions& modes) {
  const double shear_speed = std::sqrt(material.shear_modulus() / material.density);
  const double plate_speed = std::sqrt(material.youngs_modulus / material.density /
                                       (1 - material.poisson_ratio * material.poisson_ratio));
  const double stiff = 2 * (1 - material.poisson_ratio) / (1 - 2 * material.poisson_ratio);
  // Of shear and pressure waves; those along the surface come on top and make the last mode lower still.
  const double modes_a_cube =
      4 * std::numbers::pi / 3 * (2 + std::pow(stiff, -1.5)) / std::pow(shear_speed, 3);
  const double last_of_solid = std::cbrt(modes.count / (volume * modes_a_cube));
  const double shear = shear_speed / std::min(modes.max_frequency, last_of_solid);
  const double bending = std::sqrt(1.8 * plate_speed * (2 * volume / area) / modes.max_frequency);
  const double last = std::sqrt(std::numbers::pi * 0.5 * area / modes.count);
  return std::max(std::min(shear, bending), last) / 5;
}

}  // namespace intaglio::sound
