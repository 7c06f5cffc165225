// How a body of Bullet's moves relative to a textured one in the step ahead.
//
// Internal to dynamics/: includes Bullet.
#pragma once

#include <btBulletDynamicsCommon.h>

#include "intaglio/contact/contact_point.h"
#include "intaglio/core/vec.h"
#include "intaglio/dynamics/touchable_shape.h"

namespace intaglio::dynamics {

// All in the frame of the textured shape.
struct Approach {
  Pose pose;
  Vec3 velocity;  // at the end of the step if nothing touched, m/s
  Vec3 spin;      // rad/s
  Vec3 gain;      // of velocity over the step, m/s
  double reach;   // of the body around its position, m
  double lever;   // how far from its position turning moves its surface: 0 of a ball
  double dt;      // s

  Approach(const btCollisionObjectWrapper& body, const btCollisionObjectWrapper& textured, double dt);

  Vec3 velocity_at(const Vec3& point) const { return velocity + spin.cross(point - pose.position); }
  // The same, kept by those of `contacts` that are within `slack` from going deeper into what they touch.
  Vec3 held_velocity(const contact::ContactSet& contacts, double slack) const;
  // How far any of its points may move.
  double travel() const { return (velocity.norm() + spin.norm() * lever) * dt; }
  // Where it will be at the end of the step, kept by `contacts` from going through what they touch.
  Pose predicted(const contact::ContactSet& contacts) const;
};

// Contacts; the first `now` are where the body is now, the others where it would be at the end of the step:
// the distance to their plane, negative where the body is behind it already.
struct Ahead : contact::ContactSet {
  std::size_t now = 0;
  Ahead() = default;
  Ahead(const contact::ContactSet& set) : contact::ContactSet(set), now(set.count) {}
};

// Where `body` touches or will touch in the step. Contacts where it is now, and those that it would run into:
// where it will be, it is looked at again, and what it then is in by more than `slack` is added as the plane
// that it meets.
Ahead contacts_ahead(const TouchableShape& shape, const contact::Shape& body, const Approach& approach,
                     double slack);

}  // namespace intaglio::dynamics
