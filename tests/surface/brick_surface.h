// Surfaces shared by tests.
#pragma once

#include <cstdlib>
#include <functional>
#include <memory>
#include <vector>

#include "core/portable_math.h"
#include "surface/closest.h"
#include "surface/import.h"
#include "surface/surface.h"
#include "tests/sampling.h"

namespace intaglio::tests {

inline surface::Placement flat_placement(double side = 1) {
  return {Vec3::Zero(), Quat::Identity(), side, side};
}

// The built-in brick on a flat square of `side` metres, depth 2 % of it.
inline std::shared_ptr<const surface::Surface> brick_surface(int size = 128, double side = 1) {
  surface::BrickRecipe recipe;
  recipe.size = size;
  return std::make_shared<const surface::Surface>(surface::to_texels(surface::make_brick(recipe)),
                                                  flat_placement(side), 0.02 * side, surface::Edge::wrap);
}

// A square surface of n x n texels whose depth fraction and tangent normal are functions of uv.
inline std::shared_ptr<const surface::Surface> made_surface(
    int n, const std::function<double(Vec2)>& depth, const std::function<Vec3(Vec2)>& normal,
    double max_depth = 0.02, const surface::Placement& placement = flat_placement(),
    surface::Edge edge = surface::Edge::wrap) {
  surface::Texels texels;
  texels.width = texels.height = n;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const Vec2 uv((i + 0.5) / n, (j + 0.5) / n);
      texels.depth.push_back(float(depth(uv)));
      texels.normal.push_back(normal(uv).normalized());
    }
  }
  texels.colour = Image8(1, 1, 3);
  return std::make_shared<const surface::Surface>(std::move(texels), placement, max_depth, edge);
}

// A rough relief of any size, its normals those of its depth (central differences). `roughness` 0: smooth
// waves only.
inline std::shared_ptr<const surface::Surface> rough_surface(int width, int height, surface::Edge edge,
                                                             double roughness = 0.3, std::uint64_t seed = 1,
                                                             double max_depth = 0.02) {
  Random random(seed);
  const double phase = random.uniform(0, 6.28);
  const surface::Grid grid{width, height, edge};
  const double size_v = 0.7;  // metres; the other side is 1 m
  surface::Texels texels;
  texels.width = width;
  texels.height = height;
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      const double u = 6.283185307 * (i + 0.5) / width, v = 6.283185307 * (j + 0.5) / height;
      const double wave = 0.5 + 0.25 * std::sin(2 * u + phase) * std::cos(v) + 0.25 * std::sin(u + 3 * v);
      texels.depth.push_back(float((1 - roughness) * wave + roughness * random.uniform()));
    }
  }
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      const auto z = [&](int a, int b) { return -max_depth * double(texels.depth[grid.index(a, b)]); };
      texels.normal.push_back(Vec3((z(i - 1, j) - z(i + 1, j)) / (2.0 / width),
                                   (z(i, j - 1) - z(i, j + 1)) / (2 * size_v / height), 1)
                                  .normalized());
    }
  }
  texels.colour = Image8(1, 1, 3);
  return std::make_shared<const surface::Surface>(
      std::move(texels), surface::Placement(Vec3::Zero(), Quat::Identity(), 1, size_v), max_depth, edge);
}

// Sizes and edge modes for tests of queries: squares, odd sizes, the smallest.
inline std::vector<std::shared_ptr<const surface::Surface>> various_surfaces() {
  std::vector<std::shared_ptr<const surface::Surface>> out = {brick_surface(64)};
  for (const surface::Edge edge : {surface::Edge::wrap, surface::Edge::clamp}) {
    out.push_back(rough_surface(37, 53, edge));
    out.push_back(rough_surface(64, 16, edge, 0.02));
    out.push_back(rough_surface(5, 4, edge, 0.6));
    out.push_back(rough_surface(2, 2, edge, 0.8));
    out.push_back(rough_surface(1, 1, edge));
    out.push_back(rough_surface(1, 9, edge));
  }
  return out;
}

// The point of a cell that is nearest to p, as (s, t) in 0..1.
inline Vec2 closest_on_cell(const surface::Cell& cell, const Vec3& p) {
  const surface::PatchPoint found = surface::nearest(surface::LocalPatch(cell, p));
  return {found.s, found.t};
}

// The same tilt everywhere: normals of slope tan(degrees) falling towards +u, depth zero.
inline std::shared_ptr<const surface::Surface> tilted_normals(double degrees, int n = 16) {
  const double slope = std::tan(degrees * 3.14159265358979323846 / 180);
  return made_surface(
      n, [](Vec2) { return 0.0; }, [slope](Vec2) { return Vec3(slope, 0, 1); });
}

}  // namespace intaglio::tests
