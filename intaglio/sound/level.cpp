#include "intaglio/sound/level.h"

#include <cassert>
#include <cmath>

#include "intaglio/core/elementary.h"

namespace intaglio::sound {

float soft_limit(float x) {
  const float magnitude = std::abs(x);
  if (!(magnitude > limiter_knee)) return std::isnan(x) ? 0.0f : x;
  constexpr float room = 1 - limiter_knee;
  const auto beyond = static_cast<float>(elementary::tanh((magnitude - limiter_knee) / room));
  return std::copysign(limiter_knee + room * beyond, x);
}

void to_full_scale(std::span<const float> pascals, std::span<float> out, const LevelOptions& options) {
  assert(out.size() == pascals.size());
  const auto scale = static_cast<float>(elementary::pow(10.0, options.gain_db / 20) / full_scale_pascal);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = soft_limit(scale * pascals[i]);
}

}  // namespace intaglio::sound
