#include "intaglio/sound/listener.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "intaglio/core/elementary.h"

namespace intaglio::sound {

EarGains ear_gains(const Listener& listener, const Vec3& source) {
  const Vec3 way = source - listener.position;
  const double distance = way.norm();
  if (!std::isfinite(distance)) return {0, 0};
  const double loudness = 1 / std::max(distance, Listener::nearest);
  const double side = distance > 0 ? std::clamp(way.dot(listener.right) / distance, -1.0, 1.0) : 0;
  const double angle = 0.25 * std::numbers::pi * (side + 1);
  const auto [sine, cosine] = elementary::sin_cos(angle);
  return {static_cast<float>(std::numbers::sqrt2 * loudness * cosine),
          static_cast<float>(std::numbers::sqrt2 * loudness * sine)};
}

}  // namespace intaglio::sound
