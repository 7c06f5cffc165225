#include "dynamics/world_state.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "contact/shape.h"
#include "contact/surface_contacts.h"
#include "intaglio/representation.h"
#include "intaglio/vec.h"
#include "surface/closest.h"

namespace intaglio::dynamics {

// Drawn and simulated poses.

namespace {

// The gap between relief and shape, negative when they overlap. No contact is farther away than the relief is
// from the body's position, so that distance serves as the margin.
double relief_gap(const surface::Surface& relief, const contact::Shape& shape, const Pose& pose) {
  const auto nearest = closest_point(relief, relief.placement().to_local(pose.position));
  if (!nearest) return 0;
  const contact::ContactSet set =
      contact::relief_contacts(relief, shape, pose, std::max(nearest->distance, 0.0) + 1e-6);
  // Clamp overlap to 1 % of the body's size: more is not an overlap of a moving body.
  const double reach = bounding_radius(shape);
  return set.count > 0 ? std::max(set.points[0].distance, -0.01 * reach) : nearest->distance - reach;
}

double flat_gap(const surface::Surface& map, const contact::Shape& shape, const Pose& pose) {
  const double height = map.placement().to_local(pose.position).z();
  const contact::ContactSet set = contact::flat_contacts(map, shape, pose, std::max(height, 0.0) + 1e-6);
  return set.count > 0 ? set.points[0].distance : height - bounding_radius(shape);
}

}  // namespace

DrawnFrame::DrawnFrame(const surface::Surface& map, const surface::Surface& relief, const Vec2& mean_slope)
    : map_(map), relief_(relief), mean_slope_(mean_slope) {
  const surface::Placement& place = map.placement();
  level_rotation_ = rotation_onto(
      place.direction_to_world(Vec3(-mean_slope.x(), -mean_slope.y(), 1).normalized()), place.n());
}

Pose DrawnFrame::pose(const contact::Shape& shape, const Pose& simulated) const {
  Pose out{simulated.position, (level_rotation_ * simulated.orientation).normalized()};
  const double lift = relief_gap(relief_, shape, simulated) - flat_gap(map_, shape, out);
  out.position += lift * map_.placement().n();
  return out;
}

Vec3 DrawnFrame::point(const Vec3& simulated) const {
  const surface::Placement& place = map_.placement();
  return simulated - place.to_local(simulated).z() * place.n();
}

Vec3 DrawnFrame::velocity(const Vec3& simulated) const {
  const surface::Placement& place = map_.placement();
  const Vec3 local = place.direction_to_local(simulated);
  return simulated - mean_slope_.dot(local.head<2>()) * place.n();
}

Pose DrawnFrame::simulated(const contact::Shape& shape, const Pose& drawn) const {
  const double gap = flat_gap(map_, shape, drawn);
  const Vec3 n = map_.placement().n();
  Pose out{drawn.position, (level_rotation_.conjugate() * drawn.orientation).normalized()};
  // Sphere tracing: start above the relief and descend by the free distance.
  out.position +=
      (bounding_radius(shape) + std::max(gap, 0.0) - relief_.placement().to_local(drawn.position).z()) * n;
  for (int k = 0; k < 100; ++k) {
    const double excess = relief_gap(relief_, shape, out) - gap;
    out.position -= excess * n;
    if (std::abs(excess) < 1e-9) break;
  }
  return out;
}

Vec3 DrawnFrame::simulated_velocity(const Vec3& drawn) const {
  const surface::Placement& place = map_.placement();
  const Vec3 local = place.direction_to_local(drawn);
  return drawn + mean_slope_.dot(local.head<2>()) * place.n();
}

// Bodies: how they are added, and what happens to those that cannot be simulated.

namespace {

struct Inertia {
  double mass = 0;
  Vec3 moments = Vec3::Zero();
  Pose shape_pose;  // of the shape in the frame of the principal axes
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
  out.shape_pose = {axes.conjugate() * -of.centre, axes.conjugate()};
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

bool is_valid(const Inertia& inertia) {
  return std::isfinite(inertia.mass) && inertia.mass > 0 && inertia.moments.allFinite() &&
         inertia.moments.minCoeff() > 0;
}

// m. Bullet's floats are 0.01 mm apart at far_limit and 1 mm at lost_limit.
constexpr double far_limit = 100, lost_limit = 1e4;

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
  body.target.reset();
  Pose pose{at.position, at.orientation.normalized()};
  if (drawn && body.is_simulated()) pose = drawn->simulated(body.shape, pose);
  body.rigid->setWorldTransform(body.rigid_transform(pose));
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
  if (!is_valid(inertia)) added.status |= not_simulated | contact::status::no_size;
  if (!added.is_simulated()) {
    // Something that Bullet can represent, outside its world.
    added.shape = contact::Sphere{0};
    inertia = {1, Vec3::Ones(), {}};
  }
  added.shape_pose = inertia.shape_pose;
  added.reach = reach(body) + added.shape_pose.position.norm();
  if (added.is_simulated() && options.representation != Representation::flat) {
    added.faces = body.faces;
    added.skin = body.skin;
  }
  if (added.is_textured() && !is_flattened()) {
    added.texel = texel(body);
    added.bullet_shape = to_bullet(body, added.shape_pose);
  } else {
    added.bullet_shape = to_bullet(added.shape, added.shape_pose);
  }
  if (body.motion != Motion::free) inertia.mass = 0;
  btRigidBody::btRigidBodyConstructionInfo info(
      btScalar(inertia.mass), nullptr, added.bullet_shape.root(),
      to_bullet(inertia.mass > 0 ? inertia.moments : Vec3::Zero().eval()));
  // Bullet multiplies both bodies' friction: square roots make that the geometric mean.
  info.m_friction = btScalar(std::sqrt(body.material.friction));
  info.m_restitution = btScalar(body.material.restitution);
  // Bullet's rolling friction of a pair is a.rolling * b.friction + b.rolling * a.friction, a length. Ours is
  // the sum of both materials' times the radius: all of it is given to the body.
  const double floor_friction = floor->rigid.getFriction(), radius = std::visit(RollingRadius{}, added.shape);
  if (radius > 0) added.curvature = 1 / radius;
  if (floor_friction > 0)
    info.m_rollingFriction =
        btScalar((body.material.rolling_resistance + floor_rolling_resistance) * radius / floor_friction);
  info.m_spinningFriction = info.m_rollingFriction;
  info.m_linearSleepingThreshold = 0.004f;
  info.m_angularSleepingThreshold = 0.1f;
  added.rigid = std::make_unique<btRigidBody>(info);
  const auto id = BodyId(bodies.size() + 1);
  added.rigid->setUserIndex(int(id));
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
  update_status(bodies.back());
  return id;
}

World::State::Ground::Ground(std::shared_ptr<const surface::Surface> s, const Material& material,
                             const WorldOptions& o)
    : surface(s),
      shape(std::make_unique<TexturedShape>(std::move(s),
                                            ContactOptions{o.representation, o.method, o.normal_method})),
      rigid(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, shape.get())) {
  set_material(material);
}

World::State::Ground::Ground(const surface::ReliefMesh& relief, const Material& material,
                             const WorldOptions& o, double thickness)
    : curved(o.representation == Representation::relief ? relief : flattened(relief)),
      shape(std::make_unique<CurvedShape>(*curved, thickness)),
      rigid(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, shape.get())) {
  set_material(material);
}

void World::State::Ground::set_material(const Material& material) {
  rigid.setFriction(btScalar(std::sqrt(material.friction)));
  rigid.setRestitution(btScalar(material.restitution));
}

BodyId World::State::add(std::unique_ptr<Ground> ground) {
  const auto id = BodyId(first_surface_body + grounds.size());
  ground->rigid.setUserIndex(int(id));
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

// Slows a body that would move farther in a substep than contacts are looked for.
void World::State::limit_speed(Body& body) const {
  if (!body.is_moving()) return;
  const auto limited = [&](const btVector3& velocity, double limit) {
    const double speed = double(velocity.length());
    if (!(speed > limit)) return velocity;
    body.status |= slowed;
    return velocity * btScalar(limit / speed);
  };
  const double fastest = options.most_substeps * floor->shape->look_ahead() / options.step;
  body.rigid->setLinearVelocity(limited(body.rigid->getLinearVelocity(), fastest));
  // Likewise for points moved by rotation.
  const double fastest_spin = fastest / std::max(body.reach, 1e-6);
  body.rigid->setAngularVelocity(limited(body.rigid->getAngularVelocity(), fastest_spin));
}

namespace {

// Whether a position is off the rectangle, or under the relief.
unsigned place_status(const surface::Surface& relief, const Vec3& position) {
  const surface::Placement& place = relief.placement();
  const Vec3 local = place.to_local(position);
  if (!place.covers(local)) return contact::status::off_edge;
  return local.z() < -relief.depth(place.uv(local)) ? contact::status::under : 0;
}

}  // namespace

// Updates the status after a step; removes lost bodies, which keep their last valid pose.
void World::State::update_status(Body& body) {
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
    if (at.position.norm() > far_limit) body.status |= contact::status::far;
    if (at.position.norm() > lost_limit) body.status |= not_simulated;
    if (const TexturedShape* flat = floor->flat()) body.status |= place_status(flat->relief(), at.position);
  }
  if (body.is_simulated()) return;
  body.rigid->setLinearVelocity({0, 0, 0});
  body.rigid->setAngularVelocity({0, 0, 0});
  if (body.rigid->isInWorld()) world.removeRigidBody(body.rigid.get());
}

}  // namespace intaglio::dynamics
