// Vectors and poses between Bullet's floats and our doubles. Internal to dynamics/: includes Bullet.
#pragma once

#include <LinearMath/btTransform.h>
#include <btBulletCollisionCommon.h>

#include <memory>
#include <vector>

#include "contact/shape.h"
#include "intaglio/vec.h"

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

// What Bullet's shapes are to contact/.
//
// Internal to dynamics/: includes Bullet.

// Sphere, box, cylinder and capsule along any axis, compound, convex hull; any other convex shape by the hull
// of 42 of its support points. Collision margins of hulls are left out: contact is with the hull itself. A
// shape that cannot be had is a sphere without size, which touches nothing. Cost: nothing for a sphere or a
// box, milliseconds for a hull: keep the answer.
contact::Shape from_bullet(const btCollisionShape& shape);

// A Bullet shape with all that it is made of.
struct BulletShape {
  std::vector<std::unique_ptr<btCollisionShape>> parts;  // the last is the whole

  btCollisionShape* whole() const { return parts.back().get(); }
};

// The other way round, in the frame of a body that holds the shape at `pose`. Among each other, Bullet meets
// concave meshes by their hulls.
BulletShape to_bullet(const contact::Shape& shape, const Pose& pose = {});

}  // namespace intaglio::dynamics
