// What Bullet's shapes are to contact/.
//
// Internal to dynamics/: includes Bullet.
#pragma once

#include <btBulletCollisionCommon.h>

#include <memory>
#include <vector>

#include "intaglio/contact/shape.h"

namespace intaglio::dynamics {

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
