// Conversion between Bullet's vectors, poses and shapes (floats) and ours (doubles).
//
// Internal to dynamics/: includes Bullet.
#pragma once

#include <LinearMath/btTransform.h>
#include <btBulletCollisionCommon.h>

#include <memory>
#include <vector>

#include "contact/shape.h"
#include "dynamics/world.h"
#include "intaglio/error.h"
#include "intaglio/vec.h"
#include "mesh/relief_mesh.h"

namespace intaglio::dynamics {

inline btVector3 to_bullet(const Vec3& v) {
  return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())};
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
  return btTransform(btQuaternion(btScalar(q.x()), btScalar(q.y()), btScalar(q.z()), btScalar(q.w())),
                     to_bullet(pose.position));
}

// Converts a sphere, a box, a cylinder or a capsule along any axis, a compound, or a convex hull; any other
// convex shape becomes the hull of 42 of its support points. Contact is with the hull itself, without its
// collision margin. A hull of more than contact::max_hull_points corners is reduced to that many and scaled
// to the same volume.
//
// Errors name the shape: neither convex nor a compound of convex ones, or a hull without volume. Cost:
// nothing for a sphere or a box; milliseconds for a hull that is seen for the first time, and the latest ones
// are cached.
Result<contact::Shape> from_bullet(const btCollisionShape& shape);

// A Bullet shape and its children, owned.
struct BulletShape {
  std::vector<std::unique_ptr<btCollisionShape>> parts;  // the last holds the others

  btCollisionShape* root() const { return parts.back().get(); }
};

// In the frame of a body that holds the shape at `pose`. Bullet's own algorithms collide concave meshes by
// their convex hulls; from_bullet() gives back exactly the hull or mesh that was given.
BulletShape to_bullet(const contact::Shape& shape, const Pose& pose = {});

// Textured bodies of a World.

// Mass properties less the relief: a face removes its mean depth, a skin is integrated over its displaced
// corners. Zero volume for an open skin.
contact::MassProperties mass_properties(const ShapeBody& body);
// Bounding radius about the origin, m.
double reach(const ShapeBody& body);
// The finest texel of its own textures, m; 0 without.
double texel(const ShapeBody& body);

// Its reliefs, round a box that is inset by their depth, in the frame of a body that holds the shape at
// `shape_pose`. The faces come first, in their order: a child's index is that of its texture.
BulletShape to_bullet(const ShapeBody& body, const Pose& shape_pose);

// A curved base without its relief.
surface::ReliefMesh flattened(const surface::ReliefMesh& relief);

}  // namespace intaglio::dynamics
