// The contact events of a step, from Bullet's manifolds and the contact records.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "contact/contact_point.h"
#include "dynamics/world_state.h"
#include "intaglio/representation.h"

namespace intaglio::dynamics {

namespace {

// Impulse on body A at one contact over the last step, N s.
Vec3 impulse_of(const btManifoldPoint& point) {
  return from_bullet(point.m_normalWorldOnB) * double(point.m_appliedImpulse) +
         from_bullet(point.m_lateralFrictionDir1) * double(point.m_appliedImpulseLateral1) +
         from_bullet(point.m_lateralFrictionDir2) * double(point.m_appliedImpulseLateral2);
}

// Texture coordinates for contacts with a body's plain shape, which come without any: in the representation
// `normal` bodies collide without their relief, and below the faces of a textured box lies a plain box.

// The face on the side that `outwards` leaves the box by most; its rectangle may cover less than the side.
std::optional<TextureSite> face_site(const std::vector<std::shared_ptr<const surface::Surface>>& faces,
                                     const Vec3& point, const Vec3& outwards) {
  constexpr double min_cosine = 0.05, float_rounding = 1e-5;  // m
  double most = min_cosine;
  std::optional<TextureSite> out;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const surface::Placement& place = faces[k]->placement();
    const Vec3 local = place.to_local(point);
    const double cosine = outwards.dot(place.n());
    if (cosine <= most || !place.covers(local, float_rounding)) continue;
    most = cosine;
    const Vec2 uv = place.uv(local).cwiseMax(0).cwiseMin(1);
    out = TextureSite{int(k), uv, faces[k]->world_normal(uv)};
  }
  return out;
}

// The place of a skin under a point of the plain shape, which the skin need not fit exactly.
std::optional<TextureSite> skin_site(const surface::ReliefMesh& skin, const Vec3& point) {
  constexpr double max_misfit = 0.1;  // of the skin's size
  return site_under(skin, point, max_misfit * skin.bounds().sizes().norm());
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

World::State::Side World::State::side(BodyId id, const Vec3& point, const btVector3& local_point,
                                      const Vec3& outwards, const std::optional<TextureSite>& known) const {
  Side out{id, point, known};
  if (known || is_surface(id)) return out;
  const Body& body = bodies[id - 1];
  if (!body.is_textured()) return out;
  const Vec3 local = body.shape_pose.to_local(from_bullet(local_point));
  if (body.skin) {
    if (is_flattened()) out.site = skin_site(*body.skin, local);
  } else {
    out.site = face_site(body.faces, local, pose(body).orientation.conjugate() * outwards);
  }
  return out;
}

// `normal` stands in where there is no texture.
World::State::Texture World::State::texture(const Side& side, const Vec3& normal) const {
  if (!side.site) return {-1, Vec2::Zero(), normal, normal};
  const TextureSite& site = *side.site;
  const bool moves = !is_surface(side.id);
  const Quat turn = moves ? pose(bodies[side.id - 1]).orientation : Quat::Identity();
  Texture out{site.texture, site.uv, normal, turn * site.n_s};
  const auto& skin = moves ? bodies[side.id - 1].skin : ground(side.id).curved;
  if (skin) {
    const surface::BasePoint base = skin->base().at(site.triangle, site.weights);
    out.n_g = turn * base.n;
    out.sweep = skin->sweep(base, turn);
    return out;
  }
  const surface::Surface& face =
      moves ? *bodies[side.id - 1].faces[std::size_t(site.texture)] : *ground(side.id).surface;
  const surface::Placement& place = face.placement();
  out.n_g = turn * place.n();
  if (moves) {
    out.sweep.emplace();
    *out.sweep << (turn * place.t()).transpose(), (turn * place.b()).transpose();
  }
  return out;
}

Vec3 World::State::velocity_of(BodyId other, const Vec3& point) const {
  if (is_surface(other)) return Vec3::Zero();
  const btRigidBody& rigid = *bodies[other - 1].rigid;
  return from_bullet(rigid.getVelocityInLocalPoint(to_bullet(point) - rigid.getCenterOfMassPosition()));
}

// The contact point between two rolling bodies moves with their curvature-weighted mean velocity: it divides
// the line between their centres as r1 : r2, so its velocity is (r2 v1 + r1 v2) / (r1 + r2). Otherwise it
// moves with `body`.
Vec3 World::State::contact_velocity(const Body& body, BodyId other) const {
  const Vec3 own = from_bullet(body.rigid->getLinearVelocity());
  if (is_surface(other)) return own;
  const Body& partner = bodies[other - 1];
  if (partner.curvature == 0) return own;
  const Vec3 its = from_bullet(partner.rigid->getLinearVelocity());
  return (body.curvature * own + partner.curvature * its) / (body.curvature + partner.curvature);
}

const Pose& World::State::cached_drawn_pose(Body& body) {
  if (!body.drawn) body.drawn = drawn_pose(body);
  return *body.drawn;
}

Vec3 World::State::drawn_point(Body& body, BodyId other, const Vec3& point) {
  if (!drawn) return point;
  return other == floor_body ? drawn->point(point)
                             : cached_drawn_pose(body).to_world(pose(body).to_local(point));
}

ContactEvent World::State::event(Body& body, const Touch& touch, const Vec3& impulse, double dt) {
  const Contact& contact = touch.last;
  const Vec3& point = contact.other.point;
  const Texture met = texture(contact.other, contact.normal);
  const Vec3 carried = contact_velocity(body, touch.other);
  const Vec3 velocity = carried - velocity_of(touch.other, point);
  const Vec3 arm = point - from_bullet(body.rigid->getCenterOfMassPosition());
  const Vec3 turning = from_bullet(body.rigid->getAngularVelocity()).cross(arm) +
                       (from_bullet(body.rigid->getLinearVelocity()) - carried);
  ContactEvent event;
  event.time = time;
  event.body = id(*body.rigid);
  event.other = touch.other;
  event.phase = touch.was_touching ? ContactPhase::persist : ContactPhase::begin;
  event.point = drawn_point(body, touch.other, point);
  event.uv = met.uv;
  event.texture = met.index;
  event.n_g = met.n_g;
  event.n_s = met.n_s;
  event.v_t = velocity - velocity.dot(event.n_g) * event.n_g;
  event.spin = turning - turning.dot(event.n_g) * event.n_g;
  if (met.sweep) event.sweep = *met.sweep * velocity;
  if (contact.body.site) {
    const Texture own = texture(contact.body, -contact.normal);
    event.own = TexturePlace{own.index, own.uv, *own.sweep * -turning};
  }
  event.impulse = impulse;
  event.duration = dt;
  event.body_pose = cached_drawn_pose(body);
  if (!is_surface(touch.other)) event.other_pose = cached_drawn_pose(bodies[touch.other - 1]);
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
    if (!is_surface(a)) body(a).reported_impulse += impulse;
    if (!is_surface(b)) body(b).reported_impulse -= impulse;
    if (is_surface(a) && is_surface(b)) continue;
    if (!is_surface(a) && !is_surface(b)) body(a).touched_body = body(b).touched_body = true;
    const ContactRecord* known = records.find(manifold, point);
    const ContactRecord record = known != nullptr ? *known : ContactRecord{};
    const Vec3 normal = from_bullet(point.m_normalWorldOnB), on_b = from_bullet(point.m_positionWorldOnB);
    emit_point({side(a, from_bullet(point.m_positionWorldOnA), point.m_localPointA, -normal, record.on_a),
                side(b, on_b, point.m_localPointB, normal, record.on_b), normal, impulse, record.touch_time},
               on_b, dt);
  }
}

// Decides which of the two is the event's body: the one without texture, or the one that moves, or the one
// that was added first.
void World::State::emit_point(const Contact& contact, const Vec3& on_b, double dt) {
  const BodyId a = contact.body.id, b = contact.other.id;
  const auto is_textured = [&](BodyId id) { return is_surface(id) || body(id).is_textured(); };
  const auto is_free = [&](BodyId id) { return !is_surface(id) && body(id).motion == Motion::free; };
  const bool symmetric = is_textured(a) == is_textured(b);
  const bool swap = is_free(a) != is_free(b) ? is_free(b) : symmetric ? a > b : is_textured(a);
  const Contact seen = swap ? contact.swapped() : contact;
  if (emit_contact(seen, dt)) return;
  // Beside its textures, the other body may touch one of this body's.
  if (symmetric && is_free(a) && is_free(b) && emit_contact(seen.swapped(), dt)) return;
  if (options.report_pairs) emit_untextured_pair(seen, on_b, dt);
}

bool World::State::emit_contact(const Contact& contact, double dt) {
  const BodyId other = contact.other.id;
  Body& touching = body(contact.body.id);
  const bool always_has = is_surface(other) || body(other).skin;
  if (!always_has && !contact.other.site && !contact.body.site) return false;
  if (!touching.rigid->isActive()) return true;  // sleeping: no new event
  touching.touched_ground |= is_surface(other);
  Touch& touch = touching.touch(other);
  touch.is_touching = true;
  touch.last = contact;
  events.push_back(event(touching, touch, contact.impulse, dt));
  if (contact.touch_time) events.back().touch_age = dt - *contact.touch_time;
  return true;
}

// A contact of two bodies without textures. Each impact is one event without an end; resting contact is below
// the threshold.
void World::State::emit_untextured_pair(const Contact& contact, const Vec3& point, double dt) {
  Body& moved = body(contact.body.id);
  const double mass = 1 / double(moved.rigid->getInvMass());
  if (!moved.rigid->isActive() || contact.impulse.norm() < 2 * mass * options.gravity.norm() * dt) return;
  ContactEvent impact;
  impact.time = time;
  impact.body = contact.body.id;
  impact.other = contact.other.id;
  impact.phase = ContactPhase::begin;
  impact.texture = -1;
  impact.point = drawn_point(moved, impact.other, point);
  impact.n_g = impact.n_s = contact.normal;
  const Vec3 velocity = from_bullet(moved.rigid->getLinearVelocity());
  impact.v_t = velocity - velocity.dot(contact.normal) * contact.normal;
  impact.impulse = contact.impulse;
  impact.duration = dt;
  impact.body_pose = cached_drawn_pose(moved);
  impact.other_pose = cached_drawn_pose(body(impact.other));
  events.push_back(impact);
}

void World::State::emit_ended(double dt) {
  for (Body& body : bodies) {
    if (!body.is_moving()) continue;
    for (Touch& touch : body.touches) {
      if (touch.was_touching && !touch.is_touching) {
        events.push_back(event(body, touch, Vec3::Zero(), dt));
        events.back().phase = ContactPhase::end;
      }
      touch.was_touching = touch.is_touching;
    }
    std::erase_if(body.touches, [](const Touch& touch) { return !touch.is_touching; });
  }
}

namespace {

// An impact that the solver resolves a step late is dated back to the touch, with all points of the pair, if
// a point with at least a third of the impulse is late.
void date_back(std::span<ContactEvent> step, double dt) {
  double total = 0, late = 0;
  for (const ContactEvent& event : step) total += event.impulse.norm();
  for (const ContactEvent& event : step) {
    if (event.touch_age > dt && event.impulse.norm() >= total / 3)
      late = std::max(late, event.touch_age - dt);
  }
  for (ContactEvent& event : step) {
    event.time -= late;
    if (!std::isnan(event.touch_age)) event.touch_age = std::clamp(event.touch_age - late, 0.0, dt);
  }
}

}  // namespace

void World::State::collect(double dt) {
  const auto first = std::ptrdiff_t(events.size());
  for (Body& body : bodies) {
    body.reported_impulse.setZero();
    body.drawn.reset();
    body.touched_ground = body.touched_body = false;
    for (Touch& touch : body.touches) touch.is_touching = false;
  }
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m)
    collect(*dispatcher.getManifoldByIndexInternal(m), dt);
  emit_ended(dt);
  // Manifolds are in the order of Bullet's broad phase; events in the order of bodies, a pair's together.
  std::stable_sort(events.begin() + first, events.end(), [](const ContactEvent& a, const ContactEvent& b) {
    return std::tie(a.body, a.other) < std::tie(b.body, b.other);
  });
  for (auto from = events.begin() + first; from != events.end();) {
    const auto to = std::find_if(from, events.end(), [&](const ContactEvent& e) {
      return e.body != from->body || e.other != from->other;
    });
    date_back({from, to}, dt);
    from = to;
  }
}

void World::State::audit(double dt) {
  for (const Body& body : bodies) {
    if (!body.is_moving() || !body.was_awake) continue;
    const double mass = 1.0 / double(body.rigid->getInvMass());
    const double size = body.reported_impulse.norm();
    Vec3 expected = body.velocity_before + options.gravity * dt;
    if (size > 0) expected += contact::velocity_change(size / dt, dt, mass, body.reported_impulse / size);
    const Vec3 velocity = from_bullet(body.rigid->getLinearVelocity());
    momentum_residual = std::max(momentum_residual, mass * (velocity - expected).norm());
  }
}

}  // namespace intaglio::dynamics
