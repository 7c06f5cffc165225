// No energy from nowhere: what undoing a penetration lifts.
#include <algorithm>
#include <cmath>

#include "intaglio/dynamics/world_state.h"

namespace intaglio::dynamics {

namespace {

// Of a body's height, that a lift may be and not be a rescue.
constexpr double hair = 2e-3;

}  // namespace

// Kinetic and potential, J.
double World::State::energy(const btRigidBody& body) const {
  const double mass = 1 / static_cast<double>(body.getInvMass());
  const btVector3 spin = body.getAngularVelocity();
  return 0.5 * mass * static_cast<double>(body.getLinearVelocity().length2()) +
         0.5 * static_cast<double>(spin.dot(body.getInvInertiaTensorWorld().inverse() * spin)) -
         mass * options.gravity.dot(from_bullet(body.getWorldTransform().getOrigin()));
}

// Undoing a penetration lifts a body, and what only the fixed floor touches cannot gain energy: the lift is
// paid for out of its motion, through the contact that lifted it.
void World::State::pay_for_lift(Body& body) {
  if (!body.on_ground || body.met_another || is_literal()) return;
  const double gained = energy(*body.rigid) - body.energy_before;
  const double mass = 1 / static_cast<double>(body.rigid->getInvMass());
  const double kinetic = energy(*body.rigid) +
                         mass * options.gravity.dot(from_bullet(body.rigid->getWorldTransform().getOrigin()));
  if (gained <= 0) return;
  // Who cannot pay is not lifted, and goes on overlapping by a hair; but a body that is deep in is rescued.
  if (gained > kinetic && gained < mass * options.gravity.norm() * hair * body.reach)
    body.rigid->setCenterOfMassTransform(body.last_good);
  const double kept = kinetic > gained ? std::sqrt(1 - gained / kinetic) : 0;
  const Vec3 velocity = from_bullet(body.rigid->getLinearVelocity());
  const Vec3 impulse = mass * (kept - 1) * velocity;
  body.rigid->setLinearVelocity(to_bullet(kept * velocity));
  body.rigid->setAngularVelocity(body.rigid->getAngularVelocity() * static_cast<btScalar>(kept));
  body.gained += impulse;
  const auto own = std::find_if(events.rbegin(), events.rend(),
                                [&](const ContactEvent& e) { return e.body == id(*body.rigid); });
  if (own != events.rend()) own->impulse += impulse;
}

}  // namespace intaglio::dynamics
