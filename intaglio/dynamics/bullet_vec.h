// Vectors and poses between Bullet's floats and our doubles. Internal to dynamics/: includes Bullet.
#pragma once

#include <LinearMath/btTransform.h>

#include "intaglio/core/vec.h"

namespace intaglio::dynamics {

inline btVector3 to_bullet(const Vec3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}
inline Vec3 from_bullet(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}
inline Quat from_bullet(const btQuaternion& q) {
  return Quat(q.w(), q.x(), q.y(), q.z()).normalized();
}
inline Pose from_bullet(const btTransform& t) {
  return {from_bullet(t.getOrigin()), from_bullet(t.getRotation())};
}
inline btTransform to_bullet(const Pose& pose) {
  const Quat& q = pose.orientation;
  return btTransform(btQuaternion(static_cast<btScalar>(q.x()), static_cast<btScalar>(q.y()),
                                  static_cast<btScalar>(q.z()), static_cast<btScalar>(q.w())),
                     to_bullet(pose.position));
}

}  // namespace intaglio::dynamics
