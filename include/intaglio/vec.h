// Vectors, rotations and poses: Eigen's in double, under the names that the library uses.
//
// The world is right-handed, in metres, Y up. The tangent frame of a surface is t along +u, b along +v, n out
// of the surface. Quaternions are written (w, x, y, z) in constructors, as Eigen does.
//
// Functions here are pure and give the same bits on every processor and with every compiler; Eigen's and
// libm's do not. Include this header before any header of Eigen's: on ARM it keeps Eigen's packets from using
// fused multiply-add, which would change sums.
#pragma once

#ifdef __aarch64__
#include <arm_neon.h>
#undef __ARM_FEATURE_FMA
#endif

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <utility>

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

// The rotation by `angle` radians about a unit axis.
Quat rotation(double angle, const Vec3& axis);

// The rotation about the direction of `turn` by its length in radians: an angular velocity times a time.
Quat rotation(const Vec3& turn);

// The shortest rotation that turns the direction of one vector into that of another; for opposite directions,
// about any axis across them.
Quat rotation_onto(const Vec3& from, const Vec3& to);

// The angle between two orientations, 0..pi.
double angle_between(const Quat& a, const Quat& b);

// The orientation at the fraction t of the shorter rotation from a to b.
Quat between(const Quat& a, const Quat& b, double t);

}  // namespace intaglio
