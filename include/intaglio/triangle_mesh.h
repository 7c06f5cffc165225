// A triangle mesh with texture coordinates: the base under a curved texture, or the shape of a body that
// rings.
//
// Metres. Triangles wind counter-clockwise seen from outside; normals are unit, one per vertex, and smooth
// across triangles that share the vertex. v = 0 is the bottom row of the image; UVs may leave 0..1 (the
// texture repeats) and may be mirrored. A vertex on a UV seam or a hard edge is stored once for each side.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "intaglio/vec.h"

namespace intaglio {

struct TriangleMesh {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;  // one a position; zero means "not known"
  std::vector<Vec2> uvs;      // one a position
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::string> notes;  // what was repaired, a sentence each
};

}  // namespace intaglio
