// Eq. 1.3, Sterling & Lin 2016, §1.2.4: the plane that a haptic device is told to be.
#pragma once

#include "intaglio/core/vec.h"

namespace intaglio::haptics {

// All x with normal . x = offset. SI, world frame; normal is unit.
struct Plane {
  Vec3 normal = Vec3::UnitY();
  double offset = 0;

  // Metres; positive on the side the normal points to.
  double distance(const Vec3& x) const { return normal.dot(x) - offset; }
};

// The plane through p, the tip projected onto the surface, with the sampled unit normal n_s: n_s . x - n_s .
// p = 0.
// Eq. 1.3, Sterling & Lin 2016, §1.2.4
inline Plane tangent_plane(const Vec3& p, const Vec3& n_s) {
  return {n_s, n_s.dot(p)};
}

}  // namespace intaglio::haptics
