#include "intaglio/sound/curvature.h"

#include <algorithm>
#include <cmath>

namespace intaglio::sound {

namespace {

constexpr double radius_of_flat_pair = 0.01, sharpest = 1e-4;  // m
constexpr double closest_fit = 0.1;                            // of the curvature without a groove

}  // namespace

double relief_curvature(const surface::Surface& surface, const Vec2& uv, double footprint) {
  if (surface.is_flat()) return 0;
  const double reach = std::max({footprint, 2 * surface.texel_u(), 2 * surface.texel_v()});
  const Vec2 du(0.5 * reach / surface.placement().size_u(), 0),
      dv(0, 0.5 * reach / surface.placement().size_v());
  const auto slope = [&](const Vec2& at) { return surface.smooth(at, reach).gradient; };
  const double bend = (slope(uv + du) - slope(uv - du)).x() + (slope(uv + dv) - slope(uv - dv)).y();
  return -0.5 * bend / reach;
}

double contact_radius(double a, double b, double curvature) {
  double bodies = 1 / a + 1 / b;
  if (!(bodies > 0)) bodies = 1 / radius_of_flat_pair;
  return 1 / std::clamp(bodies + curvature, closest_fit * bodies, 1 / sharpest);
}

}  // namespace intaglio::sound
