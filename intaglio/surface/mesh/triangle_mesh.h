// A triangle mesh with UVs: the base under a curved texture.
//
// Metres, world axes. Triangles wind counter-clockwise seen from outside; normals are unit, one a vertex, and
// smooth across triangles that share the vertex. UVs as everywhere: v = 0 is the bottom row of the image;
// they may leave 0..1 (the texture repeats) and may be mirrored. A vertex on a UV seam or a hard edge is
// stored once for each side. What comes from a file or a user is raw; `checked` makes it sound or says in one
// line why it cannot.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "intaglio/core/error.h"
#include "intaglio/core/vec.h"

namespace intaglio::surface {

inline constexpr std::size_t max_mesh_triangles = 4'000'000;
inline constexpr std::size_t max_mesh_vertices = 12'000'000;

using Triangle = std::array<int, 3>;

struct TriangleMesh {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;  // one a position; in a raw mesh zero means "not known"
  std::vector<Vec2> uvs;      // one a position
  std::vector<Triangle> triangles;
  std::vector<std::string> notes;  // what was repaired, a sentence each
};

// The mesh, ready to be placed: normals unit (area-weighted where they were not known), windings agreeing
// with the normals, triangles without area dropped; `notes` says what was done. Idempotent. Errors: no
// triangles, no UVs, lists of different lengths, indices out of range, numbers that are not finite or beyond
// 1000 km (positions) or 1e6 (UVs), more than the limits.
Result<TriangleMesh> checked(TriangleMesh raw, const std::string& name);

// The same mesh rotated, then moved.
TriangleMesh moved(TriangleMesh mesh, const Pose& pose);

}  // namespace intaglio::surface
