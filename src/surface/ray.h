// Where a ray first meets the relief: exact, patch by patch. The oracle of the relief shader.
//
// Local coordinates, metres. No allocation; any thread. Cost: 1 us at 512 x 512, growing with the
// logarithm of the size: the pyramid is descended front to back and blocks that the ray passes above are
// skipped. Source of the patch test: a bilinear patch along a ray is a quadratic in t.
#pragma once

#include <optional>

#include "surface/surface.h"

namespace intaglio::surface {

struct RayHit {
  double t = 0;  // point = origin + t * direction
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  // unit, of the patch
};

// The first point of the relief on the ray with t in [t_min, t_max], from whichever side it is met, over the
// rectangle of the placement only. `direction` of any length but 0; nothing for numbers that are not finite
// (but t_max may be infinite).
std::optional<RayHit> intersect(const Surface& surface, const Vec3& origin, const Vec3& direction,
                                double t_min, double t_max);

}  // namespace intaglio::surface
