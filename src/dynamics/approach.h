// How a body of Bullet's moves relative to a textured one in the step ahead.
//
// Internal to dynamics/: includes Bullet.
#pragma once

#include <BulletCollision/NarrowPhaseCollision/btManifoldPoint.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <array>
#include <optional>

#include "contact/contact_point.h"
#include "dynamics/textured_shape.h"
#include "intaglio/vec.h"

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

// When within the step ahead a body's contacts close, and which of them bounce in it.
//
// Internal to dynamics/: includes Bullet.

// m/s: what touches no faster is gravity's doing in a step of `dt` s, and would chatter if it bounced.
inline double least_bounce(double gravity, double dt) {
  return std::max(0.02, gravity * dt);
}
// Bullet sees the speed before the step, to which gravity adds: of what bounces, more than this.
inline double least_seen(double least) {
  return 0.25 * least;
}

// What Bullet is told of a contact.
struct Meeting {
  bool waits = false;           // it bounces, but in a later step
  double distance = 0;          // m; what is only met later is no overlap to undo
  double restitution = 0;       // of the speed with which Bullet sees it close
  std::optional<double> touch;  // s after the step's start, of one that closes; < 0: it is resolved late
};
using Meetings = std::array<Meeting, contact::ContactSet::capacity>;

// A contact bounces when it touches faster than `least` m/s. Bullet brakes what is ahead softly, and its
// restitution is lost; so what bounces is resolved once, at full speed, in whichever step starts nearest to
// its touch, with the energy that it has left then. A ball that meets two things one after the other meets
// the second with what speed the first leaves it, and both are timed by the first. Other bodies, which a
// blow also turns, meet all at once.
Meetings meetings(const Ahead& contacts, const Approach& approach, double restitution, double least,
                  double slack);

// When within a step a contact touched: kept in two numbers of Bullet's point that only cached friction uses.
//
// Internal to dynamics/: includes Bullet.

// `delay`: s after the step's start; less than 0 for one that is resolved a step late.
inline void set_touch(btManifoldPoint& point, std::optional<double> delay) {
  point.m_contactMotion1 = static_cast<btScalar>(delay.value_or(0));
  point.m_contactMotion2 = delay ? 1 : 0;
}
inline std::optional<double> touch_of(const btManifoldPoint& point) {
  if (point.m_contactMotion2 == 0) return std::nullopt;
  return static_cast<double>(point.m_contactMotion1);
}

}  // namespace intaglio::dynamics
