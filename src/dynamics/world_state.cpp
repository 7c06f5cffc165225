#include "dynamics/world_state.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "contact/shape.h"
#include "dynamics/bullet_shape.h"
#include "dynamics/textured_shape.h"
#include "intaglio/representation.h"
#include "intaglio/vec.h"

namespace intaglio::dynamics {

namespace {

// A box between two corners.
struct Sides {
  Vec3 low, high;

  explicit Sides(const Vec3& half) : low(-half), high(half) {}
  // On the side that the normal leaves by.
  void set_back(const Vec3& normal, double by) {
    Eigen::Index axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    if (normal[axis] > 0) {
      high[axis] = std::max(high[axis] - by, low[axis] + 1e-6);
    } else {
      low[axis] = std::min(low[axis] + by, high[axis] - 1e-6);
    }
  }
  Vec3 middle() const { return 0.5 * (low + high); }
  contact::Box box() const { return {0.5 * (high - low)}; }
  double across(const Vec3& normal) const { return normal.cwiseAbs().dot(high - low); }
};

double mean_depth(const surface::Surface& s) {
  double sum = 0;
  for (int j = 0; j < s.height(); ++j)
    for (int i = 0; i < s.width(); ++i) sum -= s.texel_z(i, j);
  return s.has_depth() ? sum / (static_cast<double>(s.width()) * s.height()) : 0;
}

const contact::Box* box_of(const ShapeBody& body) {
  return body.faces.empty() ? nullptr : std::get_if<contact::Box>(&body.shape);
}

}  // namespace

contact::MassProperties mass_properties(const ShapeBody& body) {
  if (body.skin) return CurvedShape(*body.skin).enclosed();
  const contact::Box* box = box_of(body);
  if (box == nullptr) return contact::mass_properties(body.shape);
  Sides sides(box->half);
  for (const auto& face : body.faces) sides.set_back(face->placement().n(), mean_depth(*face));
  contact::MassProperties out = contact::mass_properties(sides.box());
  out.centre = sides.middle();
  return out;
}

double reach(const ShapeBody& body) {
  const double plain = contact::bounding_radius(body.shape);
  if (!body.skin) return plain;
  const surface::Box bounds = body.skin->bounds();
  return std::max(plain, bounds.min().cwiseAbs().cwiseMax(bounds.max().cwiseAbs()).norm());
}

double texel(const ShapeBody& body) {
  if (body.skin) return body.skin->texel();
  double least = 0;
  for (const auto& face : body.faces) {
    const double own = std::min(face->texel_u(), face->texel_v());
    least = least > 0 ? std::min(least, own) : own;
  }
  return least;
}

BulletShape to_bullet(const ShapeBody& body, const Pose& held) {
  BulletShape out;
  auto whole = std::make_unique<btCompoundShape>();
  const auto add = [&](std::unique_ptr<btCollisionShape> part, const Pose& pose) {
    out.parts.push_back(std::move(part));
    whole->addChildShape(to_bullet(pose), out.parts.back().get());
  };
  const contact::Box* box = box_of(body);
  if (body.skin) {
    add(std::make_unique<CurvedShape>(*body.skin), held);
  } else if (box != nullptr) {
    Sides core(box->half);
    for (const auto& face : body.faces) {
      const Vec3 n = face->placement().n();
      const double texel = std::max(face->texel_u(), face->texel_v());
      const double thickness = std::min(face->max_depth() + texel, 0.5 * Sides(box->half).across(n));
      add(std::make_unique<TexturedShape>(face, ContactOptions{}, thickness), held);
      core.set_back(n, face->max_depth());
    }
    add(std::make_unique<btBoxShape>(to_bullet(core.box().half)),
        {held.to_world(core.middle()), held.orientation});
  } else {
    return to_bullet(body.shape, held);
  }
  out.parts.push_back(std::move(whole));
  return out;
}

surface::ReliefMesh bare(const surface::ReliefMesh& relief) {
  surface::Texels flat;
  flat.width = flat.height = 4;
  flat.depth.assign(16, 0.0f);
  flat.normal.assign(16, Vec3::UnitZ());
  const auto plane = std::make_shared<const surface::Surface>(std::move(flat), relief.surface().placement(),
                                                              0.0, surface::Edge::wrap);
  auto made = surface::ReliefMesh::make(plane, relief.base());
  return made ? *made : relief;  // what has no depth cannot fold
}

}  // namespace intaglio::dynamics

// How bodies come into a world, and what is done about those that cannot be simulated.

//
namespace intaglio::dynamics {

namespace {

struct Inertia {
  double mass = 0;
  Vec3 moments = Vec3::Zero();
  Pose held;  // of the shape's frame in the frame of the principal axes
};

Inertia inertia_of(const ShapeBody& body) {
  const contact::MassProperties of = mass_properties(body);
  Inertia out;
  out.mass = body.material.density * of.volume;
  const Mat3 inertia = body.material.density * of.inertia;
  out.moments = inertia.diagonal();
  const double reach = contact::bounding_radius(body.shape);
  const Vec3 off_diagonal(inertia(0, 1), inertia(0, 2), inertia(1, 2));
  const bool turned = off_diagonal.norm() > 1e-6 * out.moments.maxCoeff();
  if (!turned && of.centre.norm() < 1e-9 * reach) return out;
  Quat axes = Quat::Identity();
  if (turned) {
    const Eigen::SelfAdjointEigenSolver<Mat3> principal(inertia);
    out.moments = principal.eigenvalues();
    Mat3 columns = principal.eigenvectors();
    if (columns.determinant() < 0) columns.col(2) *= -1;
    axes = Quat(columns).normalized();
  }
  out.held = {axes.conjugate() * -of.centre, axes.conjugate()};
  return out;
}

// The radius on which a round shape rolls; 0 for others.
struct RollingRadius {
  double operator()(const contact::Sphere& s) const { return s.radius; }
  double operator()(const contact::Capsule& s) const { return s.radius; }
  double operator()(const contact::Cylinder& s) const { return s.radius; }
  template <class Other>
  double operator()(const Other&) const {
    return 0;
  }
};

bool is_finite(const ShapeBody& body) {
  return body.pose.position.allFinite() && body.pose.orientation.coeffs().allFinite() &&
         body.velocity.allFinite() && body.angular_velocity.allFinite() &&
         body.pose.orientation.norm() > 1e-6;
}

bool is_sound(const Inertia& inertia) {
  return std::isfinite(inertia.mass) && inertia.mass > 0 && inertia.moments.allFinite() &&
         inertia.moments.minCoeff() > 0;
}

// Floats are as fine as a hundredth of a millimetre up to here, m; and a millimetre up to there.
constexpr double far_away = 100, lost = 1e4;

}  // namespace

double SphereBody::mass() const {
  return material.density * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
}

double ShapeBody::mass() const {
  return inertia_of(*this).mass;
}

BodyId World::add(const SphereBody& body) {
  ShapeBody sphere;
  sphere.shape = contact::Sphere{body.radius};
  sphere.material = body.material;
  sphere.pose = {body.position, Quat::Identity()};
  sphere.velocity = body.velocity;
  sphere.angular_velocity = body.angular_velocity;
  return state_->add(sphere);
}

BodyId World::add(const ShapeBody& body) {
  return state_->add(body);
}

void World::State::place(Body& body, const Pose& at, const Vec3& velocity, const Vec3& angular_velocity) {
  body.goal.reset();
  Pose pose{at.position, at.orientation.normalized()};
  if (drawn && body.is_simulated()) pose = drawn->simulated(body.shape, pose);
  const Quat axes = pose.orientation * body.held.orientation.conjugate();
  body.rigid->setWorldTransform(to_bullet(Pose{pose.position - axes * body.held.position, axes}));
  body.rigid->setInterpolationWorldTransform(body.rigid->getWorldTransform());
  body.rigid->setLinearVelocity(to_bullet(drawn ? drawn->simulated_velocity(velocity) : velocity));
  body.rigid->setAngularVelocity(to_bullet(angular_velocity));
}

void World::put(BodyId id, const Pose& pose, const Vec3& velocity, const Vec3& angular_velocity) {
  State::Body& body = state_->body(id);
  if (!body.is_simulated()) return;
  state_->place(body, pose, velocity, angular_velocity);
  body.rigid->activate(true);
}

BodyId World::State::add(const ShapeBody& body) {
  Body added;
  added.shape = body.shape;
  added.motion = body.motion;
  const bool finite = is_finite(body);
  if (!finite) added.status = not_simulated | contact::status::bad_pose;
  Inertia inertia = inertia_of(body);
  if (!is_sound(inertia)) added.status |= not_simulated | contact::status::no_size;
  if (!added.is_simulated()) {
    // Something that Bullet can hold, outside its world.
    added.shape = contact::Sphere{0};
    inertia = {1, Vec3::Ones(), {}};
  }
  added.held = inertia.held;
  added.reach = reach(body) + added.held.position.norm();
  if (added.is_simulated() && options.representation != Representation::flat) {
    added.faces = body.faces;
    added.skin = body.skin;
  }
  if (added.is_textured() && !is_bare()) {
    added.texel = texel(body);
    added.bullet_shape = to_bullet(body, added.held);
  } else {
    added.bullet_shape = to_bullet(added.shape, added.held);
  }
  if (body.motion != Motion::free) inertia.mass = 0;
  btRigidBody::btRigidBodyConstructionInfo info(
      static_cast<btScalar>(inertia.mass), nullptr, added.bullet_shape.whole(),
      to_bullet(inertia.mass > 0 ? inertia.moments : Vec3::Zero().eval()));
  // Bullet multiplies both bodies' friction: square roots make that the geometric mean.
  info.m_friction = static_cast<btScalar>(std::sqrt(body.material.friction));
  info.m_restitution = static_cast<btScalar>(body.material.restitution);
  // Bullet's rolling friction of a pair is a.rolling * b.friction + b.rolling * a.friction, a length. Ours is
  // the sum of both materials' times the radius: all of it is given to the body.
  const double floor_friction = floor->rigid.getFriction(), radius = std::visit(RollingRadius{}, added.shape);
  if (radius > 0) added.bend = 1 / radius;
  if (floor_friction > 0)
    info.m_rollingFriction = static_cast<btScalar>(
        (body.material.rolling_resistance + floor_rolling_resistance) * radius / floor_friction);
  info.m_spinningFriction = info.m_rollingFriction;
  info.m_linearSleepingThreshold = 0.004f;
  info.m_angularSleepingThreshold = 0.1f;
  added.rigid = std::make_unique<btRigidBody>(info);
  const auto id = static_cast<BodyId>(bodies.size() + 1);
  added.rigid->setUserIndex(static_cast<int>(id));
  if (finite) place(added, body.pose, body.velocity, body.angular_velocity);
  if (body.motion == Motion::driven) {
    added.rigid->setCollisionFlags(added.rigid->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    added.rigid->setActivationState(DISABLE_DEACTIVATION);
  }
  if (added.is_simulated())
    world.addRigidBody(
        added.rigid.get(), btBroadphaseProxy::DefaultFilter,
        options.bodies_collide ? btBroadphaseProxy::AllFilter : btBroadphaseProxy::StaticFilter);
  bodies.push_back(std::move(added));
  look_after(bodies.back());
  return id;
}

World::State::Ground::Ground(std::shared_ptr<const surface::Surface> s, const Material& material,
                             const WorldOptions& o)
    : surface(s),
      shape(std::make_unique<TexturedShape>(std::move(s),
                                            ContactOptions{o.representation, o.method, o.normal_method})),
      rigid(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, shape.get())) {
  is_made_of(material);
}

World::State::Ground::Ground(const surface::ReliefMesh& relief, const Material& material,
                             const WorldOptions& o, double thickness)
    : curved(o.representation == Representation::relief ? relief : bare(relief)),
      shape(std::make_unique<CurvedShape>(*curved, thickness)),
      rigid(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, shape.get())) {
  is_made_of(material);
}

void World::State::Ground::is_made_of(const Material& material) {
  rigid.setFriction(static_cast<btScalar>(std::sqrt(material.friction)));
  rigid.setRestitution(static_cast<btScalar>(material.restitution));
}

BodyId World::State::add(std::unique_ptr<Ground> ground) {
  const auto id = static_cast<BodyId>(first_surface_body + grounds.size());
  ground->rigid.setUserIndex(static_cast<int>(id));
  world.addRigidBody(&ground->rigid);
  grounds.push_back(std::move(ground));
  return id;
}

BodyId World::add_surface(std::shared_ptr<const surface::Surface> surface, const Material& material) {
  return state_->add(std::make_unique<State::Ground>(std::move(surface), material, state_->options));
}

BodyId World::add_surface(const surface::ReliefMesh& relief, const Material& material, double thickness) {
  return state_->add(std::make_unique<State::Ground>(relief, material, state_->options, thickness));
}

// A body that would move farther in a substep than contacts can be asked for is slowed to that.
void World::State::slow(Body& body) const {
  if (!body.is_moving()) return;
  const double fastest = options.most_substeps * floor->shape->look_ahead() / options.step;
  const double speed = static_cast<double>(body.rigid->getLinearVelocity().length());
  if (speed > fastest) {
    body.rigid->setLinearVelocity(body.rigid->getLinearVelocity() * static_cast<btScalar>(fastest / speed));
    body.status |= slowed;
  }
  // No point of it need be faster than that.
  const double fastest_spin = fastest / std::max(body.reach, 1e-6);
  const double spin = static_cast<double>(body.rigid->getAngularVelocity().length());
  if (spin > fastest_spin) {
    body.rigid->setAngularVelocity(body.rigid->getAngularVelocity() *
                                   static_cast<btScalar>(fastest_spin / spin));
    body.status |= slowed;
  }
}

namespace {

// Whether it is off the rectangle, or under the relief.
unsigned place_on(const surface::Surface& relief, const Vec3& position) {
  const surface::Placement& place = relief.placement();
  const Vec3 local = place.to_local(position);
  if (!place.covers(local)) return contact::status::off_edge;
  return local.z() < -relief.depth(place.uv(local)) ? contact::status::under : 0;
}

}  // namespace

// What is the matter with it after a step. A body that is lost is taken out of the world, where it last was.
void World::State::look_after(Body& body) {
  if (!body.is_moving()) return;
  body.status &= slowed;
  const Pose at = pose(body);
  const Vec3 velocity = from_bullet(body.rigid->getLinearVelocity());
  const Vec3 spin = from_bullet(body.rigid->getAngularVelocity());
  if (!at.position.allFinite() || !at.orientation.coeffs().allFinite() || !velocity.allFinite() ||
      !spin.allFinite()) {
    body.status |= not_simulated | contact::status::bad_pose;
    body.rigid->setWorldTransform(body.last_good);
  } else {
    body.last_good = body.rigid->getWorldTransform();
    if (at.position.norm() > far_away) body.status |= contact::status::far;
    if (at.position.norm() > lost) body.status |= not_simulated;
    if (const TexturedShape* flat = floor->flat()) body.status |= place_on(flat->relief(), at.position);
  }
  if (body.is_simulated()) return;
  body.rigid->setLinearVelocity({0, 0, 0});
  body.rigid->setAngularVelocity({0, 0, 0});
  if (body.rigid->isInWorld()) world.removeRigidBody(body.rigid.get());
}

}  // namespace intaglio::dynamics
