#include "dynamics/approach.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "dynamics/bullet_shape.h"
#include "intaglio/vec.h"

namespace intaglio::dynamics {

namespace {

struct FreeMotion {
  Vec3 velocity = Vec3::Zero(), spin = Vec3::Zero(), gravity_dv = Vec3::Zero();
};

// At the end of the step, without contacts.
FreeMotion free_motion(const btCollisionObject& object, double dt) {
  const btRigidBody* body = btRigidBody::upcast(&object);
  if (body == nullptr || object.isStaticObject()) return {};
  const btVector3 acceleration = body->getTotalForce() * body->getLinearFactor() * body->getInvMass();
  const Vec3 dv = dt * from_bullet(acceleration);
  return {from_bullet(body->getLinearVelocity()) + dv, from_bullet(body->getAngularVelocity()), dv};
}

}  // namespace

Approach::Approach(const btCollisionObjectWrapper& body, const btCollisionObjectWrapper& textured,
                   double step)
    : dt(step) {
  btVector3 middle;
  btScalar radius;
  body.getCollisionShape()->getBoundingSphere(middle, radius);
  reach = double(radius + middle.length());
  const bool is_ball =
      body.getCollisionObject()->getCollisionShape()->getShapeType() == SPHERE_SHAPE_PROXYTYPE;
  turning_radius = is_ball ? 0 : reach;
  const btTransform& frame = textured.getWorldTransform();
  pose = from_bullet(frame.inverseTimes(body.getWorldTransform()));
  const Vec3 at = from_bullet(body.getWorldTransform().getOrigin());
  const auto velocity_at = [&](const FreeMotion& m, const btCollisionObject& object) {
    return Vec3(m.velocity + m.spin.cross(at - from_bullet(object.getWorldTransform().getOrigin())));
  };
  const FreeMotion motion = free_motion(*body.getCollisionObject(), dt);
  const FreeMotion ground = free_motion(*textured.getCollisionObject(), dt);
  const Quat to_shape = from_bullet(frame.getRotation()).conjugate();
  velocity = to_shape * (velocity_at(motion, *body.getCollisionObject()) -
                         velocity_at(ground, *textured.getCollisionObject()));
  spin = to_shape * (motion.spin - ground.spin);
  gravity_dv = to_shape * (motion.gravity_dv - ground.gravity_dv);
}

namespace {

constexpr double unlimited = std::numeric_limits<double>::infinity();

// The approach's velocity, without what closes a contact c faster than allowed(c), m/s; projected on the
// planes of the contacts in turn.
template <class Allowed>
Vec3 clipped_velocity(const Approach& a, const contact::ContactSet& contacts, const Allowed& allowed) {
  Vec3 v = a.velocity;
  for (int round = 0; round < 4; ++round) {
    for (const contact::ContactPoint& c : contacts) {
      const double limit = allowed(c);
      if (limit == unlimited) continue;
      const double excess = -limit - (v + a.spin.cross(c.point - a.pose.position)).dot(c.normal);
      if (excess > 0) v += excess * c.normal;
    }
  }
  return v;
}

}  // namespace

Vec3 Approach::supported_velocity(const contact::ContactSet& contacts, double slack) const {
  return clipped_velocity(
      *this, contacts, [&](const contact::ContactPoint& c) { return c.distance <= slack ? 0.0 : unlimited; });
}

Pose Approach::predicted_pose(const contact::ContactSet& contacts) const {
  const Vec3 v = clipped_velocity(
      *this, contacts, [&](const contact::ContactPoint& c) { return std::max(c.distance, 0.0) / dt; });
  return {pose.position + v * dt, (rotation(spin * dt) * pose.orientation).normalized()};
}

namespace {

// Overlaps deeper than `slack`. For a ball, queries one smaller by slack: it usually touches nothing, which
// is cheaper to establish.
contact::ContactSet deep_contacts(const TexturedShapeBase& shape, const contact::Shape& body,
                                  const Pose& pose, double slack) {
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

// Adds the planes that the body would cross by the time it is at `later`; whether there are any.
bool add_crossings(const TexturedShapeBase& shape, const contact::Shape& body, const Approach& approach,
                   const Pose& later, double slack, contact::ContactSet& contacts) {
  const std::size_t before = contacts.count;
  for (contact::ContactPoint c : deep_contacts(shape, body, later, slack)) {
    if (contacts.count == contact::ContactSet::capacity) break;
    // The present distance to that plane of the point of the body that would penetrate.
    const Vec3 touching = approach.pose.to_world(later.to_local(c.point + c.distance * c.normal));
    c.distance = c.normal.dot(touching - c.point);
    contacts.points[contacts.count++] = c;
  }
  return contacts.count > before;
}

}  // namespace

ContactsAhead contacts_ahead(const TexturedShapeBase& shape, const contact::Shape& body,
                             const Approach& approach, double slack) {
  const double travel = approach.travel();
  // On a flat rectangle nothing new lies ahead.
  if (shape.is_plane())
    return shape.contacts(body, approach.pose, std::min(travel + slack, shape.look_ahead()));
  const double texel = shape.texel();
  // A wide margin is slow, and contacts ahead are found by the prediction below; only bodies fast enough to
  // tunnel get their full travel.
  const double margin = travel < 0.5 * approach.reach ? std::min(travel + slack, 0.3 * texel) : travel;
  ContactsAhead out = shape.contacts(body, approach.pose, std::min(margin, shape.look_ahead()));
  if (travel < 0.25 * texel || out.count == contact::ContactSet::capacity) return out;
  // New contacts change the predicted pose, so repeat a few times.
  Pose later = approach.predicted_pose(out);
  for (int round = 0; round < 3 && add_crossings(shape, body, approach, later, slack, out); ++round) {
    const Pose next = approach.predicted_pose(out);
    if ((next.position - later.position).norm() +
            approach.turning_radius * angle_between(later.orientation, next.orientation) <
        0.1 * slack)
      break;
    later = next;
  }
  return out;
}

// When contacts close, and which bounce.
//
// Bullet steps by v1 = v0 + g dt, x1 = x0 + v1 dt. Positions at the ends of steps then lie exactly on the
// parabola x(t) = x0 + w t + g t^2 / 2 whose initial velocity is that of mid-step, w = v1 - g dt / 2:
//
//        gap
//         |o                 o  positions at the ends of steps, dt apart
//         |   `.o            .  parabola through them: leaves with `start`, touches with `at_touch`
//         |       `.         x  touch, between two steps
//         |          `o
//     ----+------------`x--------------- contact plane
//                       t
//
// Along the contact normal n, with closing speeds positive:
//
//   pull     = -g dt . n                         what gravity adds to the closing speed in a step
//   start    = -v1 . n - pull / 2                on the parabola, now
//   at_touch = sqrt(start^2 + 2 (pull/dt) gap)   energy
//   t        = 2 gap / (start + at_touch)        the stable root of gap = start t + (pull/dt) t^2 / 2
//
// A step covers (start + pull/2) dt. The bounce is due in the step that starts nearest to the touch: when the
// gap is at most half of that. A bounce leaves the touch with e at_touch. Resolved now, at height gap, the
// outgoing parabola has less: w' = sqrt((e at_touch)^2 - 2 (pull/dt) gap); and the velocity in which Bullet
// must leave the body, at the end of the step, is again half a pull less:
//
//   solver_rebound = w' - pull / 2
//
// Bullet multiplies restitution by the closing speed of v0, before gravity: solver_speed = start - pull / 2.
// So the contact gets the restitution solver_rebound / solver_speed. min_solver_speed() bounds it where
// nearly all of the closing speed is this step's gravity and solver_speed is near zero.
namespace {

constexpr double min_timed_speed = 1e-3;  // m/s, of a touch that has a time
constexpr double simultaneous = 0.02;     // of a step: touches closer than that are one

struct Closing {
  double start, pull;  // m/s
  double gap, dt;      // m, s

  double at_touch() const { return std::sqrt(std::max(0.0, start * start + 2 * pull / dt * gap)); }
  // A touch that is resolved late happened at most half a step ago.
  double touch_time() const { return std::clamp(2 * gap / (start + at_touch()), -0.5 * dt, dt); }
  bool is_due() const { return std::max(gap, 0.0) <= 0.5 * (start + 0.5 * pull) * dt; }
  double solver_speed() const { return start - 0.5 * pull; }
  double solver_rebound(double restitution) const {
    const double away = restitution * at_touch();
    return std::max(0.0, std::sqrt(std::max(0.0, away * away - 2 * pull / dt * gap)) - 0.5 * pull);
  }
};

// The body's velocity at the end of the step, m/s, and whether it is in free flight or supported.
struct Trajectory {
  Vec3 velocity;
  bool is_free = true;
};

class BouncePlanner {
 public:
  BouncePlanner(const ContactsAhead& contacts, const Approach& approach, double slack)
      : contacts_(contacts),
        approach_(approach),
        slack_(slack),
        supported_velocity_(approach.supported_velocity(contacts, slack)) {}

  Closing closing(std::size_t k, const Trajectory& trajectory) const {
    const contact::ContactPoint& c = contacts_.points[k];
    const double pull = trajectory.is_free ? -approach_.gravity_dv.dot(c.normal) : 0;
    const Vec3 velocity = trajectory.velocity + approach_.spin.cross(c.point - approach_.pose.position);
    return {-velocity.dot(c.normal) - 0.5 * pull, pull, c.distance, approach_.dt};
  }
  // No contact counts.
  Trajectory free() const { return {approach_.velocity}; }
  // The motion towards contact k that the contacts closed already allow.
  Trajectory supported(std::size_t k) const {
    if (supported_velocity_ == approach_.velocity || contacts_.points[k].distance <= slack_) return free();
    return {supported_velocity_, false};
  }
  // A resting body moves from texel to texel; each new contact closes at no more than one step's gravity and
  // gets no touch time.
  std::optional<double> touch_time(std::size_t k) const {
    const contact::ContactPoint& c = contacts_.points[k];
    const double fall =
        0.5 * approach_.gravity_dv.norm() + std::max(0.0, -approach_.gravity_dv.dot(c.normal));
    const Closing own = closing(k, supported(k));
    if (!(own.start > min_timed_speed + (c.distance > slack_ ? 0 : fall))) return std::nullopt;
    return own.touch_time();
  }

 private:
  const ContactsAhead& contacts_;
  const Approach& approach_;
  double slack_;
  Vec3 supported_velocity_;
};

bool is_bounce(const Closing& closing, const Closing& free, double min_bounce) {
  return closing.start > 0 && closing.at_touch() > min_bounce &&
         free.solver_speed() > min_solver_speed(min_bounce);
}

constexpr double before_any_touch = -std::numeric_limits<double>::infinity();

// Contacts by the time of their touch; those that have none, being closed already, first.
std::array<std::size_t, contact::ContactSet::capacity> by_touch_time(const PlannedContacts& plan,
                                                                     std::size_t count) {
  std::array<std::size_t, contact::ContactSet::capacity> out{};
  for (std::size_t k = 0; k < count; ++k) out[k] = k;
  const auto key = [&](std::size_t k) {
    return std::tuple(plan[k].touch_time.value_or(before_any_touch), k);
  };
  std::sort(out.begin(), out.begin() + std::ptrdiff_t(count),
            [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  return out;
}

}  // namespace

// Which trajectory a contact is judged by:
//
//               closing speed                              is it a bounce at all?
//   ball        `current`: after all earlier touches       free
//   other body  supported by the contacts already closed   free
PlannedContacts plan_contacts(const ContactsAhead& contacts, const Approach& approach, double restitution,
                              double min_bounce, double slack) {
  PlannedContacts out;
  const BouncePlanner planner(contacts, approach, slack);
  for (std::size_t k = 0; k < contacts.count; ++k) {
    const double distance = contacts.points[k].distance;
    out[k].distance = k < contacts.current_count ? distance : std::max(distance, 0.0);
    out[k].touch_time = planner.touch_time(k);
  }
  if (restitution <= 0) return out;
  const bool is_ball = approach.turning_radius == 0;
  // For a ball, before and after the touches of one instant.
  Trajectory current = planner.free(), next = current;
  double instant = before_any_touch;
  std::optional<double> first_bounce;
  const auto order = by_touch_time(out, contacts.count);
  for (std::size_t n = 0; n < contacts.count; ++n) {
    const std::size_t k = order[n];
    PlannedContact& planned = out[k];
    const Vec3& normal = contacts.points[k].normal;
    if (planned.touch_time && *planned.touch_time > instant + simultaneous * approach.dt) {
      current = next;
      instant = *planned.touch_time;
    }
    const Closing free = planner.closing(k, planner.free());
    const Closing closing = planner.closing(k, is_ball ? current : planner.supported(k));
    if (is_bounce(closing, free, min_bounce) && closing.is_due()) {
      // At most 1: Bullet solves contacts together, and opposing ones would gain energy.
      planned.restitution = std::min(1.0, closing.solver_rebound(restitution) / free.solver_speed());
      planned.distance = std::min(planned.distance, 0.0);
      // The solver decides which contact carries a ball's impulse, so all share the first's time.
      if (is_ball) planned.touch_time = first_bounce = first_bounce ? first_bounce : planned.touch_time;
      next.velocity += (1 + restitution) * closing.at_touch() * normal;
    } else if (is_bounce(closing, free, min_bounce) ||
               (closing.start <= 0 && is_bounce(free, free, min_bounce))) {
      planned.is_deferred = true;
    } else if (closing.start > 0) {
      next = {next.velocity + (closing.start + 0.5 * closing.pull) * normal, false};
    }
  }
  return out;
}

}  // namespace intaglio::dynamics
