// The axes along which a body has most of its flat faces, so that a lattice laid along them meets those
// exactly.
#pragma once

#include <vector>

#include "intaglio/core/vec.h"
#include "intaglio/sound/triangle_grid.h"

namespace intaglio::sound {

// A rotation whose columns are the axes: the first is normal to the most area, the second to the most of the
// rest that is perpendicular to it. Identity where less than a twentieth of the area is flat. Only the 200
// largest triangles are candidates. About 1 ms for 1,000 triangles.
Mat3 flat_frame(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles);

}  // namespace intaglio::sound
