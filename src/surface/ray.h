// First intersection of a ray with the relief, exact per patch. Reference for the relief shader.
//
// Local coordinates, metres. No allocation; any thread. Cost: 1 us at 512 x 512, growing with the logarithm
// of the size: the pyramid is traversed front to back, and blocks that the ray passes above are skipped.
// Along a ray the height above a bilinear patch is quadratic in t.
#pragma once

#include <optional>

#include "surface/surface.h"

namespace intaglio::surface {

struct RayHit {
  double t = 0;  // point = origin + t * direction
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  // unit, of the patch
};

// The first point of the relief on the ray with t in [t_min, t_max], hit from either side, within the
// rectangle of the placement. `direction` has any length but 0. Empty for non-finite input, except that t_max
// may be infinite.
std::optional<RayHit> intersect(const Surface& surface, const Vec3& origin, const Vec3& direction,
                                double t_min, double t_max);

}  // namespace intaglio::surface
