// What a world's bodies touched in a step, read out of Bullet's manifolds.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "contact/contact_point.h"
#include "dynamics/approach.h"
#include "dynamics/world_state.h"
#include "intaglio/representation.h"

namespace intaglio::dynamics {

namespace {

// How far from a side that Bullet meets without relief its contact points may be, m.
constexpr double bare_slack = 1e-3;
// Of its size, how far from a skin the contacts of a step may lie by its end.
constexpr double skin_slack = 0.1;

// Impulse on body A at one contact over the last step, N s.
Vec3 impulse_of(const btManifoldPoint& point) {
  return from_bullet(point.m_normalWorldOnB) * static_cast<double>(point.m_appliedImpulse) +
         from_bullet(point.m_lateralFrictionDir1) * static_cast<double>(point.m_appliedImpulseLateral1) +
         from_bullet(point.m_lateralFrictionDir2) * static_cast<double>(point.m_appliedImpulseLateral2);
}

}  // namespace

World::State::Touch& World::State::Body::touch(BodyId other) {
  const auto same = [&](const Touch& t) { return t.other == other; };
  const auto known = std::find_if(touches.begin(), touches.end(), same);
  if (known != touches.end()) return *known;
  touches.push_back({});
  touches.back().other = other;
  return touches.back();
}

std::optional<World::State::Texture> World::State::face_texture(const Body& body, const Vec3& point,
                                                                const Vec3& normal) const {
  const Pose at = pose(body);
  const Vec3 local = at.to_local(point), out = at.orientation.conjugate() * normal;
  const double slack = 0.1 * body.texel + (is_bare() ? bare_slack : 1e-5);
  for (std::size_t k = 0; k < body.faces.size(); ++k) {
    const surface::Surface& face = *body.faces[k];
    const surface::Placement& place = face.placement();
    const Vec3 on = place.to_local(local);
    if (out.dot(place.n()) < 0.05 || !place.covers(on, slack) || on.z() > slack ||
        on.z() < -face.max_depth() - slack)
      continue;
    const Vec2 uv = place.uv(on).cwiseMax(0).cwiseMin(1);
    Texture met{uv, at.orientation * place.n(), normal, static_cast<int>(k), {}};
    if (is_bare()) met.n_s = at.orientation * face.world_normal(uv);
    met.sweep.emplace();
    *met.sweep << (at.orientation * place.t()).transpose(), (at.orientation * place.b()).transpose();
    return met;
  }
  return std::nullopt;
}

World::State::Texture World::State::curved_texture(const surface::ReliefMesh& relief, const Pose& at,
                                                   const Vec3& point, const Vec3& normal,
                                                   double reach) const {
  Texture met{Vec2::Zero(), normal, normal, -1};
  const auto under = relief.base().closest(at.to_local(point), reach);
  if (!under) return met;
  const surface::Surface& surface = relief.surface();
  met = {under->uv, at.orientation * under->n, normal};
  if (is_bare()) met.n_s = at.orientation * under->direction_to_world(surface.normal(under->uv));
  met.sweep = relief.sweep(*under, at.orientation);
  return met;
}

std::optional<World::State::Texture> World::State::texture(BodyId other, const Vec3& point,
                                                           const Vec3& normal) const {
  if (!is_surface(other)) {
    const Body& body = bodies[other - 1];
    if (!body.skin) return face_texture(body, point, normal);
    return curved_texture(*body.skin, pose(body), point, normal,
                          skin_slack * body.skin->bounds().sizes().norm());
  }
  const Ground& touched = ground(other);
  if (touched.curved)
    return curved_texture(*touched.curved, {}, point, normal,
                          touched.curved->surface().max_depth() + touched.curved->texel());
  const surface::Placement& place = touched.surface->placement();
  const Vec2 uv = place.uv(place.to_local(point));
  const bool is_flat = options.representation == Representation::flat;
  return Texture{uv, place.n(), is_flat ? place.n() : touched.surface->world_normal(uv)};
}

std::optional<World::State::Texture> World::State::own_texture(const Body& body, const Vec3& point,
                                                               const Vec3& normal) const {
  if (!body.is_textured()) return std::nullopt;
  auto own = texture(id(*body.rigid), point, -normal);
  return own && own->sweep ? own : std::nullopt;
}

Vec3 World::State::velocity_of(BodyId other, const Vec3& point) const {
  if (is_surface(other)) return Vec3::Zero();
  const btRigidBody& rigid = *bodies[other - 1].rigid;
  return from_bullet(rigid.getVelocityInLocalPoint(to_bullet(point) - rigid.getCenterOfMassPosition()));
}

// Round bodies carry the contact between them along, each the more the rounder it is; else it goes with
// `body`.
Vec3 World::State::contact_velocity(const Body& body, BodyId other) const {
  const Vec3 own = from_bullet(body.rigid->getLinearVelocity());
  if (is_surface(other)) return own;
  const Body& met = bodies[other - 1];
  if (met.bend == 0) return own;
  const Vec3 its = from_bullet(met.rigid->getLinearVelocity());
  return (body.bend * own + met.bend * its) / (body.bend + met.bend);
}

const Pose& World::State::told_pose(Body& body) {
  if (!body.drawn) body.drawn = drawn_pose(body);
  return *body.drawn;
}

Vec3 World::State::told_point(Body& body, BodyId other, const Vec3& point) {
  if (!drawn) return point;
  return other == floor_body ? drawn->point(point) : told_pose(body).to_world(pose(body).to_local(point));
}

ContactEvent World::State::event(Body& body, const Touch& touch, const Texture& texture, const Vec3& impulse,
                                 double dt) {
  const Vec3 carried = contact_velocity(body, touch.other);
  const Vec3 velocity = carried - velocity_of(touch.other, touch.point);
  const Vec3 arm = touch.point - from_bullet(body.rigid->getCenterOfMassPosition());
  const Vec3 turning = from_bullet(body.rigid->getAngularVelocity()).cross(arm) +
                       (from_bullet(body.rigid->getLinearVelocity()) - carried);
  ContactEvent event;
  event.time = time;
  event.body = id(*body.rigid);
  event.other = touch.other;
  event.phase = touch.before ? ContactPhase::persist : ContactPhase::begin;
  event.point = told_point(body, touch.other, touch.point);
  event.uv = texture.uv;
  event.texture = texture.index;
  event.n_g = texture.n_g;
  event.n_s = texture.n_s;
  event.v_t = velocity - velocity.dot(event.n_g) * event.n_g;
  event.spin = turning - turning.dot(event.n_g) * event.n_g;
  if (texture.sweep) event.sweep = *texture.sweep * velocity;
  const auto own = own_texture(body, touch.point, touch.normal);
  if (own) event.own = TexturePlace{own->index, own->uv, *own->sweep * -turning};
  event.impulse = impulse;
  event.duration = dt;
  event.body_pose = told_pose(body);
  if (!is_surface(touch.other)) event.other_pose = told_pose(bodies[touch.other - 1]);
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
    if (!is_surface(b)) body(b).gained -= impulse;
    if (is_surface(a) && is_surface(b)) continue;
    if (!is_surface(a) && !is_surface(b)) body(a).met_another = body(b).met_another = true;
    collect_point(point, impulse, a, b, dt);
  }
}

// Tells who touched whom: the one without texture, or the one that moves, or the one that was added first
// touches the other.
void World::State::collect_point(const btManifoldPoint& point, const Vec3& impulse, BodyId a, BodyId b,
                                 double dt) {
  const auto is_textured = [&](BodyId id) { return is_surface(id) || body(id).is_textured(); };
  const auto is_free = [&](BodyId id) { return !is_surface(id) && body(id).motion == Motion::free; };
  const bool both = is_textured(a) == is_textured(b);
  const bool turned = is_free(a) != is_free(b) ? is_free(b) : both ? a > b : is_textured(a);
  const auto tell = [&](bool b_touches_a) {
    const Vec3 normal = from_bullet(point.m_normalWorldOnB) * (b_touches_a ? -1 : 1);
    const Vec3 on = from_bullet(b_touches_a ? point.m_positionWorldOnA : point.m_positionWorldOnB);
    const std::size_t before = events.size();
    const bool is_told = told(b_touches_a ? b : a, b_touches_a ? a : b, on, normal,
                              b_touches_a ? Vec3(-impulse) : impulse, dt);
    if (const auto delay = touch_of(point); delay && events.size() > before)
      events.back().touch_age = dt - *delay;
    return is_told;
  };
  // What touches a textured body where it has no texture may have one itself.
  if (tell(turned) || (both && is_free(a) && is_free(b) && tell(!turned)) || !options.report_pairs) return;
  const Vec3 normal = from_bullet(point.m_normalWorldOnB) * (turned ? -1 : 1);
  collect_pair(from_bullet(point.m_positionWorldOnB), normal, turned ? Vec3(-impulse) : impulse,
               turned ? b : a, turned ? a : b, dt);
}

bool World::State::told(BodyId who, BodyId other, const Vec3& on, const Vec3& normal, const Vec3& impulse,
                        double dt) {
  Body& touching = body(who);
  std::optional<Texture> met = texture(other, on, normal);
  if (!met && own_texture(touching, on, normal)) met = Texture{Vec2::Zero(), normal, normal, -1};
  if (!met) return false;
  if (!touching.rigid->isActive()) return true;  // asleep: it is not happening again
  touching.on_ground |= is_surface(other);
  Touch& touch = touching.touch(other);
  touch.now = true;
  touch.point = on;
  touch.normal = normal;
  events.push_back(event(touching, touch, *met, impulse, dt));
  return true;
}

// Two bodies without texture between them. Each blow is told as a contact of its own, begun and over in its
// step, so that nothing lingers; resting pairs push too little to be told.
void World::State::collect_pair(const Vec3& point, const Vec3& normal, const Vec3& impulse, BodyId a,
                                BodyId b, double dt) {
  Body& moved = body(a);
  const double mass = 1 / static_cast<double>(moved.rigid->getInvMass());
  if (!moved.rigid->isActive() || impulse.norm() < 2 * mass * options.gravity.norm() * dt) return;
  ContactEvent blow;
  blow.time = time;
  blow.body = a;
  blow.other = b;
  blow.phase = ContactPhase::begin;
  blow.texture = -1;
  blow.point = told_point(moved, b, point);
  blow.n_g = blow.n_s = normal;
  const Vec3 velocity = from_bullet(moved.rigid->getLinearVelocity());
  blow.v_t = velocity - velocity.dot(normal) * normal;
  blow.impulse = impulse;
  blow.duration = dt;
  blow.body_pose = told_pose(moved);
  blow.other_pose = told_pose(body(b));
  events.push_back(blow);
}

void World::State::collect_ends(double dt) {
  for (Body& body : bodies) {
    if (!body.is_moving()) continue;
    for (Touch& touch : body.touches) {
      if (touch.before && !touch.now) {
        const auto met = texture(touch.other, touch.point, touch.normal);
        const Texture last = met.value_or(Texture{Vec2::Zero(), touch.normal, touch.normal, -1});
        events.push_back(event(body, touch, last, Vec3::Zero(), dt));
        events.back().phase = ContactPhase::end;
      }
      touch.before = touch.now;
    }
    std::erase_if(body.touches, [](const Touch& touch) { return !touch.now; });
  }
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
    body.drawn.reset();
    body.on_ground = body.met_another = false;
    for (Touch& touch : body.touches) touch.now = false;
  }
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m)
    collect(*dispatcher.getManifoldByIndexInternal(m), dt);
  collect_ends(dt);
  // Manifolds come in the order of Bullet's broad phase; events in the order of bodies, a pair's together.
  std::stable_sort(events.begin() + first, events.end(), [](const ContactEvent& a, const ContactEvent& b) {
    return std::tie(a.body, a.other) < std::tie(b.body, b.other);
  });
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
    if (!body.is_moving() || !body.was_awake) continue;
    const double mass = 1.0 / static_cast<double>(body.rigid->getInvMass());
    const double size = body.gained.norm();
    Vec3 expected = body.velocity_before + options.gravity * dt;
    if (size > 0) expected += contact::velocity_change(size / dt, dt, mass, body.gained / size);
    const Vec3 velocity = from_bullet(body.rigid->getLinearVelocity());
    momentum_residual = std::max(momentum_residual, mass * (velocity - expected).norm());
  }
}

}  // namespace intaglio::dynamics
