// Lowest and highest point of the relief over a rectangle of uv.
//
// Exact: a bilinear patch has its extremes over a rectangle at the rectangle's corners, and a block that lies
// inside the rectangle answers from the pyramid. The rectangle may reach beyond 0..1; the relief goes on
// there as the edge mode says. No allocation; any thread. Cost: proportional to the outline of the rectangle
// in cells; 3 us for 10 x 10 cells.
#pragma once

#include "intaglio/surface/surface.h"

namespace intaglio::surface {

struct Extent {
  double low = 0, high = 0;  // z in metres, local: low <= high <= 0
};

// Corners in any order; an empty rectangle is a point. A number that is not finite gives the whole relief's
// extent.
Extent extent(const Surface& surface, const Vec2& uv_a, const Vec2& uv_b);

}  // namespace intaglio::surface
