// The penalty force of a plane on a tip: a damped spring that pushes and never pulls (§1.2.4).
#pragma once

#include <algorithm>

#include "intaglio/haptics/plane.h"

namespace intaglio::haptics {

struct Spring {
  double stiffness = 600;  // N/m
  double damping = 1.0;    // N s/m
};

// Newtons along the plane's normal; zero outside. `x` and `v` are the tip's position (m) and velocity (m/s).
inline Vec3 plane_force(const Plane& plane, const Spring& spring, const Vec3& x, const Vec3& v) {
  const double depth = -plane.distance(x);
  if (depth <= 0) return Vec3::Zero();
  return std::max(0.0, spring.stiffness * depth - spring.damping * v.dot(plane.normal)) * plane.normal;
}

}  // namespace intaglio::haptics
