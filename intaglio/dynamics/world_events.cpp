// What a world's bodies touched in a step, read out of Bullet's manifolds.
#include <algorithm>
#include <cmath>

#include "intaglio/contact/impulse.h"
#include "intaglio/dynamics/touch_stamp.h"
#include "intaglio/dynamics/world_state.h"

namespace intaglio::dynamics {

namespace {

// Impulse on body A at one contact over the last step, N s.
Vec3 impulse_of(const btManifoldPoint& point) {
  return from_bullet(point.m_normalWorldOnB) * static_cast<double>(point.m_appliedImpulse) +
         from_bullet(point.m_lateralFrictionDir1) * static_cast<double>(point.m_appliedImpulseLateral1) +
         from_bullet(point.m_lateralFrictionDir2) * static_cast<double>(point.m_appliedImpulseLateral2);
}

}  // namespace

ContactEvent World::State::event(const Body& body, BodyId other, const Vec3& point, const Vec3& impulse,
                                 double dt) const {
  const surface::Surface& touched = surface_of(is_surface(other) ? other : floor_body);
  const surface::Placement& place = touched.placement();
  const Vec3 velocity = from_bullet(body.rigid->getLinearVelocity());
  ContactEvent event;
  event.time = time;
  event.body = id(*body.rigid);
  event.other = other;
  event.phase = body.touching ? ContactPhase::persist : ContactPhase::begin;
  event.point = drawn && other == floor_body ? drawn->point(point) : point;
  event.uv = place.uv(place.to_local(point));
  event.n_g = place.n();
  event.n_s = options.representation == Representation::flat ? event.n_g : touched.world_normal(event.uv);
  event.v_t = velocity - velocity.dot(event.n_g) * event.n_g;
  const Vec3 arm = point - from_bullet(body.rigid->getCenterOfMassPosition());
  const Vec3 turning = from_bullet(body.rigid->getAngularVelocity()).cross(arm);
  event.spin = turning - turning.dot(event.n_g) * event.n_g;
  event.impulse = impulse;
  event.duration = dt;
  event.body_pose = drawn_pose(body);
  return event;
}

void World::State::collect(const btPersistentManifold& manifold, double dt) {
  const BodyId a = id(*manifold.getBody0()), b = id(*manifold.getBody1());
  for (int p = 0; p < manifold.getNumContacts(); ++p) {
    const btManifoldPoint& point = manifold.getContactPoint(p);
    // Not "normal impulse > 0": Bullet's solver may leave friction on a contact whose normal impulse ended at
    // zero.
    const Vec3 impulse = impulse_of(point);
    if (impulse.isZero()) continue;
    if (!is_surface(a)) body(a).gained += impulse;
    if (!is_surface(b)) {
      body(b).gained -= impulse;
      body(a).met_another = body(b).met_another = true;
      if (options.report_pairs) collect_pair(point, impulse, a, b, dt);
      continue;
    }
    if (is_surface(a) || !body(a).rigid->isActive()) continue;  // asleep: it is not happening again
    Body& touching = body(a);
    touching.touched = true;
    touching.last_point = from_bullet(point.m_positionWorldOnB);
    touching.last_other = b;
    events.push_back(event(touching, b, touching.last_point, impulse, dt));
    if (const auto delay = touch_of(point)) events.back().touch_age = dt - *delay;
  }
}

// Two bodies without texture between them. Each blow is told as a contact of its own, begun and over in its
// step, so that nothing lingers; resting pairs push too little to be told.
void World::State::collect_pair(const btManifoldPoint& point, const Vec3& impulse, BodyId a, BodyId b,
                                double dt) {
  const bool a_moves = body(a).motion == Motion::free;
  const Body& moved = body(a_moves ? a : b);
  const double mass = 1 / static_cast<double>(moved.rigid->getInvMass());
  if (!moved.rigid->isActive() || impulse.norm() < 2 * mass * options.gravity.norm() * dt) return;
  const Vec3 normal = from_bullet(point.m_normalWorldOnB) * (a_moves ? 1 : -1);
  ContactEvent told;
  told.time = time;
  told.body = a_moves ? a : b;
  told.other = a_moves ? b : a;
  told.phase = ContactPhase::begin;
  told.point = from_bullet(point.m_positionWorldOnB);
  told.n_g = told.n_s = normal;
  const Vec3 velocity = from_bullet(moved.rigid->getLinearVelocity());
  told.v_t = velocity - velocity.dot(normal) * normal;
  told.impulse = a_moves ? impulse : Vec3(-impulse);
  told.duration = dt;
  told.body_pose = drawn_pose(moved);
  events.push_back(told);
}

namespace {

// A blow that is resolved after its touch is told as of the step that began with it, with all points of the
// pair: the first of those that bear a third of the blow decides.
void tell_when(std::span<ContactEvent> step, double dt) {
  double whole = 0, late = 0;
  for (const ContactEvent& event : step) whole += event.impulse.norm();
  for (const ContactEvent& event : step) {
    if (event.touch_age > dt && event.impulse.norm() >= whole / 3)
      late = std::max(late, event.touch_age - dt);
  }
  for (ContactEvent& event : step) {
    event.time -= late;
    if (!std::isnan(event.touch_age)) event.touch_age = std::clamp(event.touch_age - late, 0.0, dt);
  }
}

}  // namespace

void World::State::collect(double dt) {
  const auto first = static_cast<std::ptrdiff_t>(events.size());
  for (Body& body : bodies) {
    body.gained.setZero();
    body.touched = body.met_another = false;
  }
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m)
    collect(*dispatcher.getManifoldByIndexInternal(m), dt);
  for (Body& body : bodies) {
    if (!body.is_moving()) continue;
    if (body.touching && !body.touched) {
      events.push_back(event(body, body.last_other, body.last_point, Vec3::Zero(), dt));
      events.back().phase = ContactPhase::end;
    }
    body.touching = body.touched;
  }
  // Manifolds come in the order of Bullet's broad phase; events in the order of bodies.
  std::stable_sort(events.begin() + first, events.end(),
                   [](const ContactEvent& a, const ContactEvent& b) { return a.body < b.body; });
  for (auto from = events.begin() + first; from != events.end();) {
    const auto to = std::find_if(from, events.end(), [&](const ContactEvent& e) {
      return e.body != from->body || e.other != from->other;
    });
    tell_when({from, to}, dt);
    from = to;
  }
}

void World::State::audit(double dt) {
  for (const Body& body : bodies) {
    if (!body.is_moving()) continue;
    const double mass = 1.0 / static_cast<double>(body.rigid->getInvMass());
    const double size = body.gained.norm();
    Vec3 expected = body.velocity_before + options.gravity * dt;
    if (size > 0) expected += contact::velocity_change(size / dt, dt, mass, body.gained / size);
    const Vec3 velocity = from_bullet(body.rigid->getLinearVelocity());
    momentum_residual = std::max(momentum_residual, mass * (velocity - expected).norm());
  }
}

}  // namespace intaglio::dynamics
