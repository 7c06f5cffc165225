// Reliefs on curved bases, for the tests of mesh, contact and dynamics.
#pragma once

#include <doctest/doctest.h>

#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "core/portable_math.h"
#include "mesh/relief_mesh.h"
#include "tests/mesh/mesh_shapes.h"
#include "tests/surface/brick_surface.h"

namespace intaglio::tests {

inline surface::ReliefMesh relief_on(surface::TriangleMesh mesh,
                                     std::shared_ptr<const surface::Surface> surface) {
  auto base = surface::MeshPlacement::make(std::move(mesh));
  REQUIRE(base);
  auto relief = surface::ReliefMesh::make(std::move(surface), std::move(*base));
  if (!relief) FAIL(relief.error().message());
  return *relief;
}

// The texture repeated `times` times, with an offset.
inline surface::TriangleMesh tiled(surface::TriangleMesh mesh, const Vec2& times,
                                   const Vec2& from = Vec2::Zero()) {
  for (Vec2& uv : mesh.uvs) uv = uv.cwiseProduct(times) + from;
  return mesh;
}

// No depth anywhere: the base itself.
inline std::shared_ptr<const surface::Surface> no_relief() {
  return made_surface(
      4, [](Vec2) { return 0.0; }, [](Vec2) { return Vec3::UnitZ(); }, 0);
}

struct NamedRelief {
  std::string name;
  surface::ReliefMesh relief;
  double radius;  // of a body of the scale of its features, metres
  bool is_torn = true;
};

// Coarse meshes with fine textures and fine meshes with coarse ones, closed and open, bulging and hollow,
// repeated, torn at a seam, mirrored, clamped.
inline std::vector<NamedRelief> various_reliefs() {
  using surface::Edge;
  const auto rough = [](int w, int h, Edge edge, double roughness, double depth) {
    return rough_surface(w, h, edge, roughness, 7, depth);
  };
  std::vector<NamedRelief> out;
  out.push_back({"ball of 12 x 6 quads, rough 64 x 48",
                 relief_on(surface::make_sphere(0.5, 12, 6), rough(64, 48, Edge::wrap, 0.2, 0.02)), 0.08});
  out.push_back({"ball of 48 x 24 quads, bricks of 64, 2 x 1 times",
                 relief_on(tiled(surface::make_sphere(0.5, 48, 24), {2, 1}), brick_surface(64)), 0.05});
  out.push_back({"bowl of 24 x 12 quads, rough 16 x 16",
                 relief_on(surface::make_bowl(0.5, 24, 12), rough(16, 16, Edge::wrap, 0.3, 0.03)), 0.1});
  out.push_back({"pipe of 16 x 2 quads, rough 37 x 53, 3.5 x 2 times",
                 relief_on(tiled(surface::make_cylinder(0.4, 1, 16, 2), {3.5, 2}, {-1.3, 0.2}),
                           rough(37, 53, Edge::wrap, 0.1, 0.02)),
                 0.05});
  out.push_back({"hills, mirrored, rough 20 x 20, clamped",
                 relief_on(tiled(wavy(9), {-0.9, 1.1}, {0.95, -0.05}), rough(20, 20, Edge::clamp, 0.3, 0.03)),
                 0.06, false});
  out.push_back({"ball of 40 x 20 quads, no relief",
                 relief_on(surface::make_sphere(0.5, 40, 20), no_relief()), 0.1, false});
  return out;
}

// A pose near the relief: over a random point of it, `least` to `most` metres above.
inline Vec3 near_relief(Random& random, const surface::ReliefMesh& relief, double least, double most) {
  const int triangle = any_triangle(random, relief.base());
  const Vec3 weights = any_weights(random);
  return relief.point(triangle, weights) +
         random.uniform(least, most) * relief.base().at(triangle, weights).n;
}

}  // namespace intaglio::tests
