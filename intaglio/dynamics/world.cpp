#include "intaglio/dynamics/world.h"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "intaglio/contact/impulse.h"
#include "intaglio/dynamics/textured_floor.h"

namespace intaglio::dynamics {

double SphereBody::mass() const {
  return material.density * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
}

namespace {

// Impulse on body A (the ball) at one contact over the last step, N s.
Vec3 impulse_of(const btManifoldPoint& point) {
  return from_bullet(point.m_normalWorldOnB) * static_cast<double>(point.m_appliedImpulse) +
         from_bullet(point.m_lateralFrictionDir1) * static_cast<double>(point.m_appliedImpulseLateral1) +
         from_bullet(point.m_lateralFrictionDir2) * static_cast<double>(point.m_appliedImpulseLateral2);
}

}  // namespace

struct World::State {
  struct Body {
    std::unique_ptr<btSphereShape> shape;
    std::unique_ptr<btRigidBody> rigid;
    Vec3 velocity_before = Vec3::Zero();
    bool touching = false;
  };

  WorldOptions options;
  std::shared_ptr<const surface::Surface> surface;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  TexturedFloor floor_shape;
  std::unique_ptr<btRigidBody> floor;
  std::vector<Body> bodies;
  std::vector<ContactEvent> events;
  std::int64_t steps = 0;
  double momentum_residual = 0;

  State(std::shared_ptr<const surface::Surface> s, const WorldOptions& o)
      : options(o), surface(s), floor_shape(std::move(s), o) {}

  ~State() {
    for (Body& body : bodies) world.removeRigidBody(body.rigid.get());
    world.removeRigidBody(floor.get());
  }

  Body& body(BodyId id) {
    assert(id >= 1 && id <= bodies.size());
    return bodies[id - 1];
  }

  double time() const { return static_cast<double>(steps) * options.step; }
  Pose pose(const Body& body) const;
  ContactEvent event(const Body& body, const contact::ContactPoint& contact, const Vec3& impulse) const;
  void collect(const btPersistentManifold& manifold);
  void audit();
};

World::World(std::shared_ptr<const surface::Surface> floor, const Material& floor_material,
             const WorldOptions& options)
    : state_(std::make_unique<State>(std::move(floor), options)) {
  State& s = *state_;
  register_algorithms(s.dispatcher);
  s.world.setGravity(to_bullet(options.gravity));
  s.world.getSolverInfo().m_restitutionVelocityThreshold = static_cast<btScalar>(bounce_speed(options));
  s.world.getSolverInfo().m_numIterations = 30;
  btRigidBody::btRigidBodyConstructionInfo info(0, nullptr, &s.floor_shape);
  info.m_friction = static_cast<btScalar>(std::sqrt(floor_material.friction));
  info.m_restitution = static_cast<btScalar>(floor_material.restitution);
  info.m_rollingFriction = static_cast<btScalar>(floor_material.rolling_resistance);
  s.floor = std::make_unique<btRigidBody>(info);
  s.floor->setUserIndex(0);
  s.world.addRigidBody(s.floor.get());
}

World::~World() = default;

BodyId World::add(const SphereBody& body) {
  State& s = *state_;
  State::Body added;
  added.shape = std::make_unique<btSphereShape>(static_cast<btScalar>(body.radius));
  const auto mass = static_cast<btScalar>(body.mass());
  btVector3 inertia;
  added.shape->calculateLocalInertia(mass, inertia);
  btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, added.shape.get(), inertia);
  info.m_startWorldTransform.setIdentity();
  info.m_startWorldTransform.setOrigin(to_bullet(body.position));
  // Bullet multiplies both bodies' friction: square roots make that the geometric mean.
  info.m_friction = static_cast<btScalar>(std::sqrt(body.material.friction));
  info.m_restitution = static_cast<btScalar>(body.material.restitution);
  info.m_rollingFriction = static_cast<btScalar>(body.material.rolling_resistance);
  info.m_linearSleepingThreshold = 0.004f;
  info.m_angularSleepingThreshold = 0.1f;
  added.rigid = std::make_unique<btRigidBody>(info);
  added.rigid->setLinearVelocity(to_bullet(body.velocity));
  added.rigid->setAngularVelocity(to_bullet(body.angular_velocity));
  s.bodies.push_back(std::move(added));
  const auto id = static_cast<BodyId>(s.bodies.size());
  s.bodies.back().rigid->setUserIndex(static_cast<int>(id));
  s.world.addRigidBody(s.bodies.back().rigid.get());
  return id;
}

void World::step() {
  State& s = *state_;
  for (State::Body& body : s.bodies) body.velocity_before = from_bullet(body.rigid->getLinearVelocity());
  s.world.stepSimulation(static_cast<btScalar>(s.options.step), 0);
  ++s.steps;
  s.events.clear();
  for (int m = 0; m < s.dispatcher.getNumManifolds(); ++m)
    s.collect(*s.dispatcher.getManifoldByIndexInternal(m));
  // Manifolds come in the order of Bullet's broad phase; events in the order of bodies.
  std::stable_sort(s.events.begin(), s.events.end(),
                   [](const ContactEvent& a, const ContactEvent& b) { return a.body < b.body; });
  s.audit();
}

Pose World::State::pose(const Body& body) const {
  const btTransform& t = body.rigid->getWorldTransform();
  const btQuaternion q = t.getRotation();
  return {from_bullet(t.getOrigin()), Quat(q.w(), q.x(), q.y(), q.z()).normalized()};
}

ContactEvent World::State::event(const Body& body, const contact::ContactPoint& contact,
                                 const Vec3& impulse) const {
  const Vec3 n_g = surface->placement().n();
  const Vec3 velocity = from_bullet(body.rigid->getLinearVelocity());
  ContactEvent event;
  event.time = time();
  event.body = static_cast<BodyId>(body.rigid->getUserIndex());
  event.phase = body.touching ? ContactPhase::persist : ContactPhase::begin;
  event.point = contact.point;
  event.uv = contact.uv;
  event.n_g = n_g;
  event.n_s = contact.n_s;
  event.v_t = velocity - velocity.dot(n_g) * n_g;
  event.impulse = impulse;
  event.duration = options.step;
  event.body_pose = pose(body);
  return event;
}

void World::State::collect(const btPersistentManifold& manifold) {
  Body& body = bodies[static_cast<std::size_t>(manifold.getBody0()->getUserIndex()) - 1];
  if (!body.rigid->isActive()) return;  // asleep: its last contacts are not happening again
  const contact::ContactSet& contacts = floor_shape.last(body.rigid->getUserIndex());
  bool touching = false;
  for (int p = 0; p < manifold.getNumContacts(); ++p) {
    const btManifoldPoint& point = manifold.getContactPoint(p);
    // Not "normal impulse > 0": Bullet's solver may leave friction on a contact whose normal impulse ended at
    // zero.
    const Vec3 impulse = impulse_of(point);
    if (impulse.isZero()) continue;
    touching = true;
    events.push_back(event(body, contacts.points[static_cast<std::size_t>(point.m_index0)], impulse));
  }
  if (body.touching && !touching) {
    ContactEvent end = event(body, contacts.points[0], Vec3::Zero());
    end.phase = ContactPhase::end;
    events.push_back(end);
  }
  body.touching = touching;
}

void World::State::audit() {
  for (const Body& body : bodies) {
    if (!body.rigid->isActive()) continue;
    const double mass = 1.0 / static_cast<double>(body.rigid->getInvMass());
    Vec3 expected = body.velocity_before + options.gravity * options.step;
    for (const ContactEvent& e : events) {
      if (e.body != static_cast<BodyId>(body.rigid->getUserIndex()) || e.impulse.isZero()) continue;
      const double size = e.impulse.norm();
      expected += contact::velocity_change(size / e.duration, e.duration, mass, e.impulse / size);
    }
    const Vec3 velocity = from_bullet(body.rigid->getLinearVelocity());
    momentum_residual = std::max(momentum_residual, mass * (velocity - expected).norm());
  }
}

std::span<const ContactEvent> World::events() const {
  return state_->events;
}
double World::time() const {
  return state_->time();
}
std::size_t World::body_count() const {
  return state_->bodies.size();
}
Pose World::pose(BodyId body) const {
  return state_->pose(state_->body(body));
}
Vec3 World::velocity(BodyId body) const {
  return from_bullet(state_->body(body).rigid->getLinearVelocity());
}
Vec3 World::angular_velocity(BodyId body) const {
  return from_bullet(state_->body(body).rigid->getAngularVelocity());
}
void World::push(BodyId body, const Vec3& impulse) {
  btRigidBody& rigid = *state_->body(body).rigid;
  rigid.activate(true);
  rigid.applyCentralImpulse(to_bullet(impulse));
}
double World::momentum_residual() const {
  return state_->momentum_residual;
}

}  // namespace intaglio::dynamics
