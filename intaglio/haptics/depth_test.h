// The paper's collision test of the pen's tip: against the base plane, or in relief against the depth map.
#pragma once

#include "intaglio/core/representation.h"
#include "intaglio/surface/surface.h"

namespace intaglio::haptics {

struct DepthTest {
  bool collides = false;
  Vec3 projected = Vec3::Zero();  // local; the point of the surface under the tip
};

// Whether the tip (local frame) collides, and the point of the surface under it: in relief only below the
// depth map, otherwise below the base plane; never beside the rectangle. Real-time, 0.05 us.
// §1.3.2, Sterling & Lin 2016
inline DepthTest depth_test(const surface::Surface& surface, Representation representation,
                            const Vec3& tip_local) {
  const surface::Placement& place = surface.placement();
  if (!tip_local.allFinite() || !place.covers(tip_local)) return {};
  const double z = representation == Representation::relief ? -surface.depth(place.uv(tip_local)) : 0.0;
  return {tip_local.z() < z, Vec3(tip_local.x(), tip_local.y(), z)};
}

}  // namespace intaglio::haptics
