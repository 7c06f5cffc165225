// Vectors and rotations: Eigen's, in double, under the project's names.
//
// World: right-handed, metres, Y up. Tangent frame of a surface: t along +u, b along +v, n out of the
// surface.
#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "core/eigen.h"
#include "core/portable_math.h"

//
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

namespace intaglio {

// Rotations by an angle. Eigen's and Bullet's ask libm for sines; these give the same bits everywhere
// (core/elementary.h).

// By `angle` radians about a unit axis.
inline Quat rotation(double angle, const Vec3& axis) {
  const auto [sine, cosine] = elementary::sin_cos(0.5 * angle);
  const Vec3 v = sine * axis;
  return Quat(cosine, v.x(), v.y(), v.z());
}

// By a vector along the axis, as long as the angle (radians): an angular velocity times a time.
inline Quat rotation(const Vec3& turn) {
  const double angle = turn.norm();
  return angle > 0 ? rotation(angle, turn / angle) : Quat::Identity();
}

// The shortest that turns the direction of one vector into that of another; of opposite ones about any axis
// across. Eigen's FromTwoVectors, without its singular value decomposition, which costs 6 s to compile.
inline Quat rotation_onto(const Vec3& from, const Vec3& to) {
  const Vec3 a = from.normalized(), b = to.normalized();
  const double cosine = b.dot(a);
  if (cosine < -1 + 1e-12) {
    const Vec3 across = a.cross(std::abs(a.x()) < 0.6 ? Vec3::UnitX() : Vec3::UnitY()).normalized();
    return Quat(0, across.x(), across.y(), across.z());
  }
  const double s = std::sqrt((1 + cosine) * 2);
  const Vec3 v = a.cross(b) * (1 / s);
  return Quat(s * 0.5, v.x(), v.y(), v.z());
}

// By what angle two orientations differ, 0..pi.
inline double angle_between(const Quat& a, const Quat& b) {
  const Quat d = a.conjugate() * b;
  return 2 * elementary::atan2(d.vec().norm(), std::abs(d.w()));
}

// The orientation a share t of the shorter way from a to b.
inline Quat between(const Quat& a, const Quat& b, double t) {
  const Quat d = a.conjugate() * b;
  const double across = d.vec().norm();
  if (!(across > 0)) return a;
  return a * rotation(std::copysign(t * angle_between(a, b), d.w()), d.vec() / across);
}

}  // namespace intaglio
