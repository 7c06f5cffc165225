// Where a ray first meets the relief: exact, patch by patch. The oracle of the relief shader.
//
// Local coordinates, metres. No allocation; any thread. Cost: one quadratic for each cell under the ray's path through the
// relief layer. Source of the patch test: a bilinear patch along a ray is a quadratic in t.
#pragma once

#include <optional>

#include "intaglio/surface/surface.h"

namespace intaglio::surface {

struct RayHit {
  double t = 0;                  // point = origin + t * direction
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();   // unit, of the patch
};

// First crossing, from above to below, with t in (t_min, t_max), over the rectangle of the placement only.
std::optional<RayHit> intersect(const Surface& surface, const Vec3& origin, const Vec3& direction, double t_min, double t_max);

}  // namespace intaglio::surface
