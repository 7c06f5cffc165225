#include "intaglio/sound/acceleration_noise.h"

#include <cmath>
#include <numbers>

#include "intaglio/sound/air.h"

namespace intaglio::sound {

Resonator acceleration_noise(double area) {
  const double radius = std::sqrt(area / (4 * std::numbers::pi));
  const double rate = speed_of_sound / radius;
  return {std::numbers::sqrt2 * rate, rate, air_density * speed_of_sound * radius};
}

double acceleration_gain(double mass) {
  return 1 / (std::sqrt(3.0) * mass);
}

}  // namespace intaglio::sound
