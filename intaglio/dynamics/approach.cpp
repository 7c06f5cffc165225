#include "intaglio/dynamics/approach.h"

#include <algorithm>

#include "intaglio/core/rotation.h"
#include "intaglio/dynamics/bullet_vec.h"

namespace intaglio::dynamics {

namespace {

struct Motion {
  Vec3 velocity = Vec3::Zero(), spin = Vec3::Zero(), gain = Vec3::Zero();
};

// At the end of the step, were there no contacts.
Motion free_motion(const btCollisionObject& object, double dt) {
  const btRigidBody* body = btRigidBody::upcast(&object);
  if (body == nullptr || object.isStaticObject()) return {};
  const btVector3 push = body->getTotalForce() * body->getLinearFactor() * body->getInvMass();
  const Vec3 gain = dt * from_bullet(push);
  return {from_bullet(body->getLinearVelocity()) + gain, from_bullet(body->getAngularVelocity()), gain};
}

}  // namespace

Approach::Approach(const btCollisionObjectWrapper& body, const btCollisionObjectWrapper& textured,
                   double step)
    : dt(step) {
  btVector3 middle;
  btScalar radius;
  body.getCollisionShape()->getBoundingSphere(middle, radius);
  reach = static_cast<double>(radius + middle.length());
  lever =
      body.getCollisionObject()->getCollisionShape()->getShapeType() == SPHERE_SHAPE_PROXYTYPE ? 0 : reach;
  const btTransform& frame = textured.getWorldTransform();
  pose = from_bullet(frame.inverseTimes(body.getWorldTransform()));
  const Motion motion = free_motion(*body.getCollisionObject(), dt);
  const Vec3 at = from_bullet(body.getWorldTransform().getOrigin());
  const auto carried = [&](const Motion& m, const btCollisionObject& object) {
    return Vec3(m.velocity + m.spin.cross(at - from_bullet(object.getWorldTransform().getOrigin())));
  };
  const Motion ground = free_motion(*textured.getCollisionObject(), dt);
  const Quat to_shape = from_bullet(frame.getRotation()).conjugate();
  velocity = to_shape *
             (carried(motion, *body.getCollisionObject()) - carried(ground, *textured.getCollisionObject()));
  spin = to_shape * (motion.spin - ground.spin);
  gain = to_shape * (motion.gain - ground.gain);
}

Vec3 Approach::held_velocity(const contact::ContactSet& contacts, double slack) const {
  Vec3 v = velocity;
  for (int round = 0; round < 4; ++round) {
    for (const contact::ContactPoint& c : contacts) {
      const double excess = -(v + spin.cross(c.point - pose.position)).dot(c.normal);
      if (c.distance <= slack && excess > 0) v += excess * c.normal;
    }
  }
  return v;
}

Pose Approach::predicted(const contact::ContactSet& contacts) const {
  Vec3 v = velocity;
  for (int round = 0; round < 4; ++round) {
    for (const contact::ContactPoint& c : contacts) {
      // Each contact may close its gap and no more.
      const double excess =
          -std::max(c.distance, 0.0) / dt - (v + spin.cross(c.point - pose.position)).dot(c.normal);
      if (excess > 0) v += excess * c.normal;
    }
  }
  return {pose.position + v * dt, (rotation(spin * dt) * pose.orientation).normalized()};
}

namespace {

// What the body would be in by more than `slack`. Of a ball, a smaller one is asked: mostly it touches
// nothing, and that is found out sooner than what a whole one touches.
contact::ContactSet deep_contacts(const TouchableShape& shape, const contact::Shape& body, const Pose& pose,
                                  double slack) {
  contact::ContactSet out;
  const auto* ball = std::get_if<contact::Sphere>(&body);
  const bool shrinks = ball != nullptr && ball->radius > 2 * slack;
  const contact::ContactSet all =
      shape.contacts(shrinks ? contact::Shape(contact::Sphere{ball->radius - slack}) : body, pose, 0);
  for (contact::ContactPoint c : all) {
    if (shrinks) c.distance -= slack;
    if (c.distance < -slack) out.points[out.count++] = c;
  }
  return out;
}

// Adds what the body would be in when it is at `later`; whether there was any.
bool add_met(const TouchableShape& shape, const contact::Shape& body, const Approach& approach,
             const Pose& later, double slack, contact::ContactSet& contacts) {
  const std::size_t before = contacts.count;
  for (contact::ContactPoint c : deep_contacts(shape, body, later, slack)) {
    if (contacts.count == contact::ContactSet::capacity) break;
    // The point of the body that would be inside, where it is now: how far before the plane that it meets?
    const Vec3 touching = approach.pose.to_world(later.to_local(c.point + c.distance * c.normal));
    c.distance = c.normal.dot(touching - c.point);
    contacts.points[contacts.count++] = c;
  }
  return contacts.count > before;
}

}  // namespace

Ahead contacts_ahead(const TouchableShape& shape, const contact::Shape& body, const Approach& approach,
                     double slack) {
  const double travel = approach.travel();
  // On a flat rectangle nothing new lies ahead.
  if (shape.is_plane())
    return shape.contacts(body, approach.pose, std::min(travel + slack, shape.look_ahead()));
  const double texel = shape.texel();
  // The wider the margin the longer the search, and what lies ahead is found by looking there. Only who moves
  // so far that it could end up behind the surface looks all the way.
  const double margin = travel < 0.5 * approach.reach ? std::min(travel + slack, 0.3 * texel) : travel;
  Ahead now = shape.contacts(body, approach.pose, std::min(margin, shape.look_ahead()));
  if (travel < 0.25 * texel || now.count == contact::ContactSet::capacity) return now;
  // What is added may turn the body into something else: look again, a few times. Of a body that is in the
  // surface already and cannot leave it within the step, it does not.
  Pose later = approach.predicted(now);
  for (int round = 0; round < 3 && add_met(shape, body, approach, later, slack, now); ++round) {
    const Pose next = approach.predicted(now);
    if ((next.position - later.position).norm() +
            approach.lever * angle_between(later.orientation, next.orientation) <
        0.1 * slack)
      break;
    later = next;
  }
  return now;
}

}  // namespace intaglio::dynamics
