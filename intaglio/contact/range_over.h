// How high and how deep the relief is somewhere, roughly and at once. Internal to contact/.
#pragma once

#include "intaglio/surface/surface.h"

namespace intaglio::contact {

struct HeightRange {
  double low, high;  // z, local frame, metres
};

// Bounds of the relief over low..high in plan, from at most nine blocks of the pyramid; loose by what lies
// beside the rectangle in them. Under wrap only one period is looked at.
HeightRange range_over(const surface::Surface& surface, const Vec2& low, const Vec2& high);

}  // namespace intaglio::contact
