// The connected parts of a triangle mesh.
//
// Pure, any thread; linear but for a logarithm.
#pragma once

#include <vector>

#include "intaglio/sound/triangle_grid.h"

namespace intaglio::sound {

struct SurfaceParts {
  std::vector<int> of_point;  // numbered from 0; a point of no triangle is a part of its own
  int count = 0;
};
SurfaceParts surface_parts(std::size_t points, const std::vector<Triangle>& triangles);

// The triangles that have area and do not bound a hollow inside a body, out of which no sound gets: of parts
// that enclose a negative volume.
std::vector<Triangle> outside_of(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles);

}  // namespace intaglio::sound
