// How a body approaches a textured shape in the coming step, when it touches, and which contacts bounce.
//
// Internal to dynamics/: includes Bullet.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <array>
#include <optional>

#include "contact/contact_point.h"
#include "dynamics/textured_shape.h"
#include "intaglio/vec.h"

namespace intaglio::dynamics {

// Motion of a body relative to a textured shape in the coming step, in the shape's frame.
struct Approach {
  Pose pose;
  Vec3 velocity;          // at the end of the step if nothing touches, m/s
  Vec3 spin;              // rad/s
  Vec3 gravity_dv;        // what the step adds to the velocity, m/s
  double reach;           // of the body around its position, m
  double turning_radius;  // at which rotation moves the body's surface; 0 for a ball
  double dt;              // s

  Approach(const btCollisionObjectWrapper& body, const btCollisionObjectWrapper& textured, double dt);

  // The velocity after contacts within `slack` have stopped its closing part.
  Vec3 supported_velocity(const contact::ContactSet& contacts, double slack) const;
  // The farthest that any point of the body may move.
  double travel() const { return (velocity.norm() + spin.norm() * turning_radius) * dt; }
  // The pose at the end of the step, if every contact may close its gap and no more.
  Pose predicted_pose(const contact::ContactSet& contacts) const;
};

// The first `current_count` contacts are current; the rest are predicted for the end of the step, with the
// signed distance to their plane.
struct ContactsAhead : contact::ContactSet {
  std::size_t current_count = 0;
  ContactsAhead() = default;
  ContactsAhead(const contact::ContactSet& set) : contact::ContactSet(set), current_count(set.count) {}
};

// Where `body` touches or will touch in the step: its contacts now; and any overlap deeper than `slack` at
// the predicted pose, as a contact with the plane that it crosses.
ContactsAhead contacts_ahead(const TexturedShapeBase& shape, const contact::Shape& body,
                             const Approach& approach, double slack);

// m/s: slower contacts come from one step of gravity and would chatter if they bounced.
inline double min_bounce_speed(double gravity, double dt) {
  return std::max(0.02, gravity * dt);
}
// Bullet applies restitution to the speed before gravity is added. A bounce needs at least this much of that
// speed; otherwise the ratio of the rebound to it would have no bound.
inline double min_solver_speed(double min_bounce) {
  return 0.25 * min_bounce;
}

// A contact as passed to Bullet.
struct PlannedContact {
  bool is_deferred = false;          // it bounces, but in a later step
  double distance = 0;               // m; a predicted contact is no overlap to correct
  double restitution = 0;            // relative to the closing speed that Bullet sees
  std::optional<double> touch_time;  // s after the start of the step, of a contact that closes; < 0: late
};
using PlannedContacts = std::array<PlannedContact, contact::ContactSet::capacity>;

// A contact bounces when it touches faster than `min_bounce` m/s. Bullet brakes contacts ahead softly, and
// their restitution is lost; so a bounce is resolved once, at full speed, in the step that starts nearest to
// its touch, with the energy that it has left then. A ball that hits two surfaces in one step hits the second
// with the velocity left by the first; both get the first's time. For other bodies, whose rotation changes in
// an impact, all contacts of a step are simultaneous.
PlannedContacts plan_contacts(const ContactsAhead& contacts, const Approach& approach, double restitution,
                              double min_bounce, double slack);

}  // namespace intaglio::dynamics
