#include "dynamics/approach.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "dynamics/bullet_shape.h"
#include "intaglio/vec.h"

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

namespace {

constexpr double least_closing = 1e-3;  // m/s, of a touch that has a time
constexpr double at_once = 0.02;        // of a step: touches that are one

// How a contact closes. Bullet's steps move a body with the speed of their end: where it is at the ends of
// steps is on a parabola that is half a step's gain slower.
struct Closing {
  double start;  // m/s, on the parabola at the step's start
  double pull;   // m/s, into what is touched, that the step adds
  double gap, dt;

  double at_touch() const { return std::sqrt(std::max(0.0, start * start + 2 * pull / dt * gap)); }
  double when() const { return std::clamp(2 * gap / (start + at_touch()), -0.5 * dt, dt); }
  // Whether this step starts nearer to the touch than the next.
  bool is_due() const { return std::max(gap, 0.0) <= 0.5 * (start + 0.5 * pull) * dt; }
  // As Bullet sees it, which takes the speed before the step.
  double seen() const { return start - 0.5 * pull; }
  // What Bullet is to leave it, so that the parabola has the energy that the bounce leaves at the touch.
  double left(double restitution) const {
    const double away = restitution * at_touch();
    return std::max(0.0, std::sqrt(std::max(0.0, away * away - 2 * pull / dt * gap)) - 0.5 * pull);
  }
};

// The body's velocity at the step's end, m/s, and whether it flies or is held by something.
struct Course {
  Vec3 velocity;
  bool flies = true;
};

class Meeter {
 public:
  Meeter(const Ahead& contacts, const Approach& approach, double slack)
      : contacts_(contacts),
        approach_(approach),
        slack_(slack),
        held_velocity_(approach.held_velocity(contacts, slack)) {}

  Closing closing(std::size_t k, const Course& course) const {
    const contact::ContactPoint& c = contacts_.points[k];
    const double pull = course.flies ? -approach_.gain.dot(c.normal) : 0;
    const Vec3 velocity = course.velocity + approach_.spin.cross(c.point - approach_.pose.position);
    return {-velocity.dot(c.normal) - 0.5 * pull, pull, c.distance, approach_.dt};
  }
  Course free() const { return {approach_.velocity}; }
  // As what touches it already lets it come.
  Course held(std::size_t k) const {
    if (held_velocity_ == approach_.velocity || contacts_.points[k].distance <= slack_) return free();
    return {held_velocity_, false};
  }
  // What lies still on one texel after the other presses anew on each, with no more speed than a step's fall.
  std::optional<double> touch(std::size_t k) const {
    const contact::ContactPoint& c = contacts_.points[k];
    const double fall = 0.5 * approach_.gain.norm() + std::max(0.0, -approach_.gain.dot(c.normal));
    const Closing own = closing(k, held(k));
    if (!(own.start > least_closing + (c.distance > slack_ ? 0 : fall))) return std::nullopt;
    return own.when();
  }

 private:
  const Ahead& contacts_;
  const Approach& approach_;
  double slack_;
  Vec3 held_velocity_;
};

bool is_bounce(const Closing& closing, const Closing& free, double least) {
  return closing.start > 0 && closing.at_touch() > least && free.seen() > least_seen(least);
}

using Order = std::array<std::size_t, contact::ContactSet::capacity>;

// Contacts by the time of their touch; those that are pressed already first.
Order in_order(const Meetings& met, std::size_t count) {
  Order out{};
  for (std::size_t k = 0; k < count; ++k) out[k] = k;
  const auto when = [&](std::size_t k) { return std::tuple(met[k].touch.value_or(-1e9), k); };
  std::sort(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(count),
            [&](std::size_t a, std::size_t b) { return when(a) < when(b); });
  return out;
}

}  // namespace

Meetings meetings(const Ahead& contacts, const Approach& approach, double restitution, double least,
                  double slack) {
  Meetings out;
  const Meeter meeter(contacts, approach, slack);
  for (std::size_t k = 0; k < contacts.count; ++k) {
    const double distance = contacts.points[k].distance;
    out[k].distance = k < contacts.now ? distance : std::max(distance, 0.0);
    out[k].touch = meeter.touch(k);
  }
  if (restitution <= 0) return out;
  const bool is_ball = approach.lever == 0;
  const Order order = in_order(out, contacts.count);
  Course course = meeter.free(), after = course;  // of a ball, before and after the touches of one time
  double now = -1e9;
  std::optional<double> first;
  for (std::size_t n = 0; n < contacts.count; ++n) {
    const std::size_t k = order[n];
    const Vec3& normal = contacts.points[k].normal;
    if (out[k].touch && *out[k].touch > now + at_once * approach.dt) {
      course = after;
      now = *out[k].touch;
    }
    const Closing free = meeter.closing(k, meeter.free());
    const Closing closing = meeter.closing(k, is_ball ? course : meeter.held(k));
    if (is_bounce(closing, free, least) && closing.is_due()) {
      // Never more than came: Bullet solves all at once, and would give two that face each other energy.
      out[k].restitution = std::min(1.0, closing.left(restitution) / free.seen());
      out[k].distance = std::min(out[k].distance, 0.0);
      // Which of the contacts bears a ball's bounces off two in one step is the solver's choice.
      if (is_ball) out[k].touch = first = first ? first : out[k].touch;
      after.velocity += (1 + restitution) * closing.at_touch() * normal;
    } else if (is_bounce(closing, free, least) || (closing.start <= 0 && is_bounce(free, free, least))) {
      out[k].waits = true;
    } else if (closing.start > 0) {
      after = {after.velocity + (closing.start + 0.5 * closing.pull) * normal, false};
    }
  }
  return out;
}

}  // namespace intaglio::dynamics
