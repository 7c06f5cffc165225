// Tangent frames of a mesh, by the rules of MikkTSpace (M. Mikkelsen, "Simulation of wrinkled surfaces
// revisited", 2008), which normal maps are baked for.
//
// Each triangle says which way u grows across it. The corners that have the same position, normal, UV and
// handedness share one tangent: the mean of what their triangles say, each laid into the tangent plane of the
// vertex normal and weighted by the angle of its corner. Triangles with mirrored UVs never mix with the
// others. Unlike MikkTSpace, two fans that touch in one vertex only are not told apart. Triangles without
// area in the texture say nothing and take what their unmirrored neighbours say.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "intaglio/surface/mesh/triangle_mesh.h"

namespace intaglio::surface {

// t along +u, b along +v, n out of the surface: unit and perpendicular to each other.
struct TangentFrame {
  Vec3 t, b, n;
};

struct CornerTangents {
  std::vector<std::array<Vec3, 3>> t;   // unit, perpendicular to the corner's normal
  std::vector<std::int8_t> handedness;  // of each triangle: +1, or -1 where the UVs are mirrored
};

CornerTangents corner_tangents(const TriangleMesh& mesh);

// The frame with normal n (unit) whose t is nearest to `tangent`; b = handedness * n x t.
TangentFrame frame_along(const Vec3& n, const Vec3& tangent, double handedness);

// How the position of a triangle changes with u and v, metres; both zero where the triangle has no area in
// the texture.
struct UvDerivatives {
  Vec3 by_u, by_v;
  double handedness;  // +1 or -1; +1 where there is no area
};
UvDerivatives uv_derivatives(const TriangleMesh& mesh, std::size_t triangle);

}  // namespace intaglio::surface
