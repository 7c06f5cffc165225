#include "dynamics/world.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "dynamics/approach.h"
#include "dynamics/world_state.h"
#include "intaglio/vec.h"

namespace intaglio::dynamics {

World::State::State(std::unique_ptr<Ground> made, const Material& material, const WorldOptions& o)
    : options(o), floor(std::move(made)) {
  if (const TexturedShape* flat = floor->flat(); flat && &flat->relief() != floor->surface.get())
    drawn.emplace(*floor->surface, flat->relief(), flat->mean_slope());
  world.setGravity(to_bullet(options.gravity));
  btContactSolverInfo& info = world.getSolverInfo();
  info.m_numIterations = 30;
  // Penetration is corrected by moving bodies: velocity corrections add energy.
  info.m_splitImpulse = 1;
  info.m_splitImpulsePenetrationThreshold = 0;
  floor_rolling_resistance = material.rolling_resistance;
  floor->rigid.setUserIndex(int(floor_body));
  world.addRigidBody(&floor->rigid);
}

World::State::~State() {
  for (Body& body : bodies)
    if (body.rigid->isInWorld()) world.removeRigidBody(body.rigid.get());
  for (const auto& ground : grounds) world.removeRigidBody(&ground->rigid);
  world.removeRigidBody(&floor->rigid);
}

World::State::Body& World::State::body(BodyId id) {
  assert(id >= 1 && id <= bodies.size());
  return bodies[id - 1];
}

World::World(std::shared_ptr<const surface::Surface> floor, const Material& floor_material,
             const WorldOptions& options)
    : state_(
          std::make_unique<State>(std::make_unique<State::Ground>(std::move(floor), floor_material, options),
                                  floor_material, options)) {}

World::World(const surface::ReliefMesh& floor, const Material& floor_material, const WorldOptions& options)
    : state_(std::make_unique<State>(std::make_unique<State::Ground>(floor, floor_material, options,
                                                                     TexturedShapeBase::unlimited_thickness),
                                     floor_material, options)) {}

World::~World() = default;
World::World(World&&) noexcept = default;

// Enough substeps that no body moves farther in one than a texel (or 7.5 % of its size if that is larger).
int World::State::substeps() const {
  double count = 1;
  for (const Body& body : bodies) {
    if (!body.is_moving()) continue;
    const double speed =
        double(body.rigid->getLinearVelocity().length()) + options.gravity.norm() * options.step;
    const double texel = body.texel > 0 ? std::min(body.texel, floor->shape->texel()) : floor->shape->texel();
    const double stride = std::min(body.reach, std::max(texel, 0.075 * body.reach));
    count = std::max(count, std::ceil(speed * options.step / stride));
  }
  return int(std::min(count, double(options.most_substeps)));
}

void World::step() {
  State& s = *state_;
  s.events.clear();
  for (State::Body& body : s.bodies) body.status &= ~slowed;
  const int count = s.substeps();
  const double dt = s.options.step / count;
  for (int k = 0; k < count; ++k) {
    s.drive(1.0 / (count - k));
    s.advance(dt);
  }
  s.time = double(++s.steps) * s.options.step;
}

void World::State::drive(double share) {
  for (Body& body : bodies) {
    if (!body.target) continue;
    const Pose from = from_bullet(body.rigid->getWorldTransform()), to = from_bullet(*body.target);
    const bool arrives = share == 1;
    // Bullet takes the speed of a kinematic body from where it was a step ago.
    body.rigid->setWorldTransform(arrives
                                      ? *body.target
                                      : to_bullet(Pose{from.position + share * (to.position - from.position),
                                                       between(from.orientation, to.orientation, share)}));
    if (arrives) body.target.reset();
  }
}

void World::State::advance(double dt) {
  for (Body& body : bodies) {
    if (body.motion != Motion::free) continue;
    limit_speed(body);
    body.velocity_before = from_bullet(body.rigid->getLinearVelocity());
    body.energy_before = energy(*body.rigid);
    body.was_awake = body.rigid->isActive();
  }
  world.getSolverInfo().m_restitutionVelocityThreshold =
      btScalar(min_solver_speed(min_bounce_speed(options.gravity.norm(), dt)));
  world.stepSimulation(btScalar(dt), 0);
  time += dt;
  collect(dt);
  for (Body& body : bodies) {
    if (body.motion != Motion::free) continue;
    remove_lift_energy(body);
    update_status(body);
  }
  audit(dt);
}

std::span<const ContactEvent> World::events() const {
  return state_->events;
}
double World::time() const {
  return state_->time;
}
std::size_t World::body_count() const {
  return state_->bodies.size();
}
Pose World::pose(BodyId body) const {
  return state_->pose(state_->body(body));
}
Pose World::drawn_pose(BodyId body) const {
  return state_->drawn_pose(state_->body(body));
}
Vec3 World::velocity(BodyId body) const {
  return from_bullet(state_->body(body).rigid->getLinearVelocity());
}
Vec3 World::drawn_velocity(BodyId body) const {
  const Vec3 simulated = velocity(body);
  return state_->drawn ? state_->drawn->velocity(simulated) : simulated;
}
Vec3 World::angular_velocity(BodyId body) const {
  return from_bullet(state_->body(body).rigid->getAngularVelocity());
}
void World::push(BodyId body, const Vec3& impulse) {
  if (!state_->body(body).is_simulated()) return;
  btRigidBody& rigid = *state_->body(body).rigid;
  rigid.activate(true);
  rigid.applyCentralImpulse(to_bullet(impulse));
}
void World::push(BodyId body, const Vec3& impulse, const Vec3& point) {
  State::Body& pushed = state_->body(body);
  if (!pushed.is_simulated() || pushed.motion != Motion::free) return;
  btRigidBody& rigid = *pushed.rigid;
  const Vec3 simulated =
      state_->drawn ? state_->pose(pushed).to_world(state_->drawn_pose(pushed).to_local(point)) : point;
  rigid.activate(true);
  rigid.applyImpulse(to_bullet(impulse), to_bullet(simulated) - rigid.getWorldTransform().getOrigin());
}
void World::drive(BodyId body, const Pose& pose) {
  State::Body& driven = state_->body(body);
  if (driven.motion != Motion::driven || !driven.is_simulated()) return;
  driven.target = driven.rigid_transform(pose);
}
unsigned World::status(BodyId body) const {
  return state_->body(body).status;
}
double World::momentum_residual() const {
  return state_->momentum_residual;
}

// Kinetic and potential, J.
double World::State::energy(const btRigidBody& body) const {
  const double mass = 1 / double(body.getInvMass());
  const btVector3 spin = body.getAngularVelocity();
  return 0.5 * mass * double(body.getLinearVelocity().length2()) +
         0.5 * double(spin.dot(body.getInvInertiaTensorWorld().inverse() * spin)) -
         mass * options.gravity.dot(from_bullet(body.getWorldTransform().getOrigin()));
}

// Correcting a penetration lifts a body, but a body that touches nothing but fixed ground cannot gain energy.
// So the energy of the lift is taken from the body's motion, as an impulse of the contact that lifted it:
// scaling the velocity by sqrt(1 - gained / kinetic) reduces the kinetic energy by exactly `gained`.
void World::State::remove_lift_energy(Body& body) {
  if (!body.touched_ground || body.touched_body || is_literal()) return;
  constexpr double lift_tolerance = 2e-3;  // of the body's reach; higher lifts are a rescue
  const double gained = energy(*body.rigid) - body.energy_before;
  const double mass = 1 / double(body.rigid->getInvMass());
  const double kinetic = energy(*body.rigid) +
                         mass * options.gravity.dot(from_bullet(body.rigid->getWorldTransform().getOrigin()));
  if (gained <= 0) return;
  // If the kinetic energy does not cover a small lift, undo it and accept the overlap; deep overlaps are
  // still corrected.
  if (gained > kinetic && gained < mass * options.gravity.norm() * lift_tolerance * body.reach)
    body.rigid->setCenterOfMassTransform(body.last_good);
  const double kept = kinetic > gained ? std::sqrt(1 - gained / kinetic) : 0;
  const Vec3 velocity = from_bullet(body.rigid->getLinearVelocity());
  const Vec3 impulse = mass * (kept - 1) * velocity;
  body.rigid->setLinearVelocity(to_bullet(kept * velocity));
  body.rigid->setAngularVelocity(body.rigid->getAngularVelocity() * btScalar(kept));
  body.reported_impulse += impulse;
  const auto own = std::find_if(events.rbegin(), events.rend(),
                                [&](const ContactEvent& e) { return e.body == id(*body.rigid); });
  if (own != events.rend()) own->impulse += impulse;
}

}  // namespace intaglio::dynamics
