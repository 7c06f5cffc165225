// Rotations with sines of our own, whose bits are the same everywhere (core/portable_math.h).
#include "intaglio/vec.h"

#include <cmath>

#include "core/portable_math.h"

namespace intaglio {

Quat rotation(double angle, const Vec3& axis) {
  const auto [sine, cosine] = elementary::sin_cos(0.5 * angle);
  const Vec3 v = sine * axis;
  return Quat(cosine, v.x(), v.y(), v.z());
}

Quat rotation(const Vec3& turn) {
  const double angle = turn.norm();
  return angle > 0 ? rotation(angle, turn / angle) : Quat::Identity();
}

// Eigen's FromTwoVectors, without its singular value decomposition, which costs 6 s to compile.
Quat rotation_onto(const Vec3& from, const Vec3& to) {
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

double angle_between(const Quat& a, const Quat& b) {
  const Quat d = a.conjugate() * b;
  return 2 * elementary::atan2(d.vec().norm(), std::abs(d.w()));
}

Quat between(const Quat& a, const Quat& b, double t) {
  const Quat d = a.conjugate() * b;
  const double across = d.vec().norm();
  if (!(across > 0)) return a;
  return a * rotation(std::copysign(t * angle_between(a, b), d.w()), d.vec() / across);
}

}  // namespace intaglio
