// A triangle mesh with UVs: the base under a curved texture.
//
// Metres, world axes. Triangles wind counter-clockwise seen from outside; normals are unit, one a vertex, and
// smooth across triangles that share the vertex. UVs: v = 0 is the bottom row of the image, as everywhere;
// they may leave 0..1 (the texture repeats) and may be mirrored. A vertex on a UV seam or a hard edge is
// stored once for each side. Input is raw; `checked` repairs it or returns an error.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/triangle_mesh.h"
#include "intaglio/vec.h"
#include "surface/surface.h"

namespace intaglio::surface {

inline constexpr std::size_t max_mesh_triangles = 4'000'000;
inline constexpr std::size_t max_mesh_vertices = 12'000'000;

using Triangle = std::array<int, 3>;

using intaglio::TriangleMesh;

// The mesh, ready to be placed: normals unit (area-weighted where they were missing), windings that agree
// with the normals, triangles without area dropped; `notes` lists the repairs. Idempotent. Errors: no
// triangles, no UVs, lists of different lengths, indices out of range, numbers that are not finite or beyond
// 1000 km (positions) or 1e6 (UVs), more than the limits.
Result<TriangleMesh> checked(TriangleMesh raw, const std::string& name);

// The same mesh rotated, then moved.
TriangleMesh moved(TriangleMesh mesh, const Pose& pose);

// Tangent frames of a mesh, by the rules of MikkTSpace (M. Mikkelsen, "Simulation of wrinkled surfaces
// revisited", 2008), which normal maps are baked for.
//
// Each triangle has a direction in which u grows. The corners that have the same position, normal, UV and
// handedness share one tangent: the mean of their triangles' directions, each projected to the tangent plane
// of the vertex normal and weighted by the angle of its corner. Triangles with mirrored UVs never mix with
// the others. Unlike MikkTSpace, two fans that touch in one vertex only are not separated. Triangles without
// area in the texture contribute nothing and use their unmirrored neighbours' tangent.

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

// Derivatives of a triangle's position by u and v, metres; both zero where it has no area in the texture.
struct UvDerivatives {
  Vec3 by_u, by_v;
  double handedness;  // +1 or -1; +1 where there is no area
};
UvDerivatives uv_derivatives(const TriangleMesh& mesh, std::size_t triangle);

// Meshes of known shape, for tests and first experiments: a quad, a sphere, a cylinder and a bowl.
//
// All have their axis along +Y and their middle at the origin; `moved` puts them elsewhere. Vertices lie on
// the shape itself and normals are the shape's own, so finer meshes converge to the shape.

// Two triangles that are the rectangle of a Placement, u and v along its sides.
TriangleMesh make_quad(const Placement& placement);

// u goes once around the equator, eastwards; v from the south pole to the north pole. Normals outwards.
TriangleMesh make_sphere(double radius, int around, int up);

// The side only, without lids: u goes once around, v up the height. Normals outwards.
TriangleMesh make_cylinder(double radius, double height, int around, int up);

// The inside of the lower hemisphere: u goes once around, westwards; v from the bottom to the rim. Normals
// inwards.
TriangleMesh make_bowl(double radius, int around, int up);

}  // namespace intaglio::surface
