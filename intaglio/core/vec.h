// Vectors and rotations: Eigen's, in double, under the project's names.
//
// World: right-handed, metres, Y up. Tangent frame of a surface: t along +u, b along +v, n out of the
// surface.
#pragma once

#include "intaglio/core/eigen.h"
//
#include <Eigen/Geometry>

namespace intaglio {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;

// Where a body is: rotate by `orientation`, then move to `position` (metres, world).
struct Pose {
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();

  Vec3 to_world(const Vec3& local) const { return orientation * local + position; }
  Vec3 to_local(const Vec3& world) const { return orientation.conjugate() * (world - position); }
};

}  // namespace intaglio
