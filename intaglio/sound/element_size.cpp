#include "intaglio/sound/element_size.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace intaglio::sound {

namespace {

constexpr int rigid_modes = 6;                                // which the law counts too
constexpr double in_a_shear_wave = 4, in_a_bending_wave = 5;  // elements

// Below which a solid has `count` modes by Weyl's law: of shear and pressure waves in its volume, and those
// that its free surface adds, four in ten of a ball's first hundred.
double last_of_solid(double volume, double area, double shear_speed, double poisson_ratio, int count) {
  const double r = 2 * (1 - poisson_ratio) / (1 - 2 * poisson_ratio);  // of speeds squared, pressure to shear
  const double in_volume = 4 * std::numbers::pi / 3 * volume * (2 + std::pow(r, -1.5));
  const double on_surface = std::numbers::pi / 4 * area * (2 - 3 * r + 3 * r * r) / (r * (r - 1));
  double low = 0, high = std::cbrt(count / in_volume);  // in waves a metre
  for (int k = 0; k < 50; ++k) {
    const double x = 0.5 * (low + high);
    (in_volume * x * x * x + on_surface * x * x < count ? low : high) = x;
  }
  return shear_speed * high;
}

}  // namespace

double element_size(double volume, double area, const Material& material, const ModeOptions& modes) {
  const int count = modes.count + rigid_modes;
  const double shear_speed = std::sqrt(material.shear_modulus() / material.density);
  const double plate_speed = std::sqrt(material.youngs_modulus / material.density /
                                       (1 - material.poisson_ratio * material.poisson_ratio));
  const double last =
      std::min(modes.max_frequency, last_of_solid(volume, area, shear_speed, material.poisson_ratio, count));
  const double shear = shear_speed / last;
  const double bending = std::sqrt(1.8 * plate_speed * (2 * volume / area) / modes.max_frequency);
  const double last_bending = std::sqrt(std::numbers::pi * 0.5 * area / count);
  return std::max(std::min(shear / in_a_shear_wave, bending / in_a_bending_wave),
                  last_bending / in_a_bending_wave);
}

}  // namespace intaglio::sound
