// What a world's bodies touched in a step, read out of Bullet's manifolds.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "intaglio/contact/impulse.h"
#include "intaglio/dynamics/touch_stamp.h"
#include "intaglio/dynamics/world_state.h"

namespace intaglio::dynamics {

namespace {

// How far from a side that Bullet meets without relief its contact points may be, m.
constexpr double bare_slack = 1e-3;

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

World::State::Texture World::State::skin_texture(const surface::ReliefMesh& skin, const Pose& at,
                                                 const Vec3& point, const Vec3& normal) const {
  // Bare, it is met as the shape that its triangles stand for.
  const double slack = is_bare() ? bare_slack + 0.01 * skin.bounds().sizes().norm() : 0;
  const auto under =
      skin.base().closest(at.to_local(point), skin.surface().max_depth() + skin.texel() + slack);
  Texture met{Vec2::Zero(), normal, normal};
  met.sweep = Eigen::Matrix<double, 2, 3>::Zero();
  if (!under) return met;
  met.uv = under->uv;
  met.n_g = at.orientation * under->n;
  if (is_bare()) met.n_s = at.orientation * under->direction_to_world(skin.surface().normal(under->uv));
  Eigen::Matrix<double, 2, 3> along;
  along << (at.orientation * under->t).transpose(), (at.orientation * under->b).transpose();
  const Eigen::Matrix2d stretch = skin.base().stretch(*under);
  if (stretch.determinant() != 0)
    met.sweep = skin.surface().placement().size().asDiagonal() * stretch.inverse() * along;
  return met;
}

std::optional<World::State::Texture> World::State::texture(BodyId other, const Vec3& point,
                                                           const Vec3& normal) const {
  if (!is_surface(other)) {
    const Body& body = bodies[other - 1];
    return body.skin ? skin_texture(*body.skin, pose(body), point, normal)
                     : face_texture(body, point, normal);
  }
  const Ground& touched = ground(other);
  if (touched.curved) return skin_texture(*touched.curved, {}, point, normal);
  const surface::Placement& place = touched.surface->placement();
  const Vec2 uv = place.uv(place.to_local(point));
  const bool is_flat = options.representation == Representation::flat;
  return Texture{uv, place.n(), is_flat ? place.n() : touched.surface->world_normal(uv)};
}

Vec3 World::State::velocity_of(BodyId other, const Vec3& point) const {
  if (is_surface(other)) return Vec3::Zero();
  const btRigidBody& rigid = *bodies[other - 1].rigid;
  return from_bullet(rigid.getVelocityInLocalPoint(to_bullet(point) - rigid.getCenterOfMassPosition()));
}

ContactEvent World::State::event(const Body& body, const Touch& touch, const Texture& texture,
                                 const Vec3& impulse, double dt) const {
  const Vec3& point = touch.point;
  const Vec3 velocity = from_bullet(body.rigid->getLinearVelocity()) - velocity_of(touch.other, point);
  ContactEvent event;
  event.time = time;
  event.body = id(*body.rigid);
  event.other = touch.other;
  event.phase = touch.before ? ContactPhase::persist : ContactPhase::begin;
  event.point = drawn && touch.other == floor_body ? drawn->point(point) : point;
  event.uv = texture.uv;
  event.texture = texture.index;
  event.n_g = texture.n_g;
  event.n_s = texture.n_s;
  event.v_t = velocity - velocity.dot(event.n_g) * event.n_g;
  const Vec3 arm = point - from_bullet(body.rigid->getCenterOfMassPosition());
  const Vec3 turning = from_bullet(body.rigid->getAngularVelocity()).cross(arm);
  event.spin = turning - turning.dot(event.n_g) * event.n_g;
  if (texture.sweep) event.sweep = *texture.sweep * event.v_t;
  // The contact goes along with the body's centre, past what turns there.
  if (body.is_textured())
    if (const auto own = this->texture(event.body, point, -touch.normal); own && own->sweep)
      event.own = TexturePlace{own->index, own->uv, *own->sweep * -event.spin};
  event.impulse = impulse;
  event.duration = dt;
  event.body_pose = drawn_pose(body);
  if (!is_surface(touch.other)) event.other_pose = drawn_pose(bodies[touch.other - 1]);
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
  const std::optional<Texture> met = texture(other, on, normal);
  if (!met) return false;
  Body& touching = body(who);
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
  const Body& moved = body(a);
  const double mass = 1 / static_cast<double>(moved.rigid->getInvMass());
  if (!moved.rigid->isActive() || impulse.norm() < 2 * mass * options.gravity.norm() * dt) return;
  ContactEvent blow;
  blow.time = time;
  blow.body = a;
  blow.other = b;
  blow.phase = ContactPhase::begin;
  blow.point = point;
  blow.n_g = blow.n_s = normal;
  const Vec3 velocity = from_bullet(moved.rigid->getLinearVelocity());
  blow.v_t = velocity - velocity.dot(normal) * normal;
  blow.impulse = impulse;
  blow.duration = dt;
  blow.body_pose = drawn_pose(moved);
  blow.other_pose = drawn_pose(body(b));
  events.push_back(blow);
}

void World::State::collect_ends(double dt) {
  for (Body& body : bodies) {
    if (!body.is_moving()) continue;
    for (Touch& touch : body.touches) {
      if (touch.before && !touch.now) {
        const auto met = texture(touch.other, touch.point, touch.normal);
        const Texture last = met.value_or(Texture{Vec2::Zero(), touch.normal, touch.normal});
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
