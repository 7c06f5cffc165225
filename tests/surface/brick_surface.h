// Surfaces that several tests ask for.
#pragma once

#include <functional>
#include <memory>

#include "intaglio/surface/import.h"
#include "intaglio/surface/surface.h"

namespace intaglio::tests {

inline surface::Placement flat_placement(double side = 1) { return {Vec3::Zero(), Quat::Identity(), side, side}; }

// The built-in brick on a flat square of `side` metres, depth 2 % of it.
inline std::shared_ptr<const surface::Surface> brick_surface(int size = 128, double side = 1) {
  surface::BrickRecipe recipe;
  recipe.size = size;
  return std::make_shared<const surface::Surface>(surface::to_texels(surface::make_brick(recipe)), flat_placement(side), 0.02 * side, surface::Edge::wrap);
}

// A square surface of n x n texels whose depth fraction and tangent normal are functions of uv.
inline std::shared_ptr<const surface::Surface> made_surface(int n, const std::function<double(Vec2)>& depth, const std::function<Vec3(Vec2)>& normal,
                                                            double max_depth = 0.02, const surface::Placement& placement = flat_placement(),
                                                            surface::Edge edge = surface::Edge::wrap) {
  surface::Texels texels;
  texels.width = texels.height = n;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const Vec2 uv((i + 0.5) / n, (j + 0.5) / n);
      texels.depth.push_back(static_cast<float>(depth(uv)));
      texels.normal.push_back(normal(uv).normalized());
    }
  }
  texels.colour = Image8(1, 1, 3);
  return std::make_shared<const surface::Surface>(std::move(texels), placement, max_depth, edge);
}

// The same tilt everywhere: normals of slope tan(degrees) falling towards +u, depth zero.
inline std::shared_ptr<const surface::Surface> tilted_normals(double degrees, int n = 16) {
  const double slope = std::tan(degrees * 3.14159265358979323846 / 180);
  return made_surface(n, [](Vec2) { return 0.0; }, [slope](Vec2) { return Vec3(slope, 0, 1); });
}

}  // namespace intaglio::tests
