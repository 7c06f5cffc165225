// What a World holds. Internal to dynamics/: includes Bullet.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <memory>
#include <optional>
#include <vector>

#include "intaglio/dynamics/bullet_shape.h"
#include "intaglio/dynamics/bullet_vec.h"
#include "intaglio/dynamics/drawn.h"
#include "intaglio/dynamics/textured_shape.h"
#include "intaglio/dynamics/world.h"

namespace intaglio::dynamics {

struct World::State {
  struct Body {
    contact::Shape shape;
    Pose held;  // of the shape in Bullet's frame: principal axes round the centre of mass
    BulletShape bullet_shape;
    std::unique_ptr<btRigidBody> rigid;
    double reach = 0;                // m, of the shape around its centre of mass
    Vec3 gained = Vec3::Zero();      // N s, reported in this step
    Vec3 last_point = Vec3::Zero();  // where it last touched
    Vec3 velocity_before = Vec3::Zero();
    btTransform last_good = btTransform::getIdentity();
    double energy_before = 0;  // J
    unsigned status = 0;
    Motion motion = Motion::free;
    BodyId last_other = floor_body;
    bool touching = false, touched = false, met_another = false;

    bool is_simulated() const { return (status & not_simulated) == 0; }
    bool is_moving() const { return motion == Motion::free && is_simulated() && rigid->isActive(); }
  };
  // A surface beside the floor.
  struct Ground {
    std::shared_ptr<const surface::Surface> surface;
    TexturedShape shape;
    btRigidBody rigid;

    Ground(std::shared_ptr<const surface::Surface> s, const ContactOptions& options)
        : surface(s),
          shape(std::move(s), options),
          rigid(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &shape)) {}
  };

  WorldOptions options;
  std::shared_ptr<const surface::Surface> surface;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  TexturedShape floor_shape;
  std::optional<Drawn> drawn;  // when what is simulated is not what is drawn
  btRigidBody floor;
  double floor_rolling_resistance = 0;
  std::vector<Body> bodies;
  std::vector<std::unique_ptr<Ground>> grounds;
  std::vector<ContactEvent> events;
  double time = 0;
  std::int64_t steps = 0;
  double momentum_residual = 0;

  State(std::shared_ptr<const surface::Surface> s, const Material& material, const WorldOptions& o);
  ~State();

  Body& body(BodyId id);
  BodyId add(const ShapeBody& body);  // world_bodies.cpp
  void place(Body& body, const Pose& pose, const Vec3& velocity, const Vec3& angular_velocity);
  BodyId id(const btCollisionObject& object) const { return static_cast<BodyId>(object.getUserIndex()); }
  Pose pose(const Body& b) const {
    const Pose whole = from_bullet(b.rigid->getWorldTransform());
    return {whole.to_world(b.held.position), whole.orientation * b.held.orientation};
  }
  Pose drawn_pose(const Body& b) const { return drawn ? drawn->pose(b.shape, pose(b)) : pose(b); }
  void advance(double dt);
  int substeps() const;
  // The paper's normal substitution, which knows no energy.
  bool is_literal() const {
    return options.representation == Representation::normal && options.normal_method == NormalMethod::literal;
  }
  double energy(const btRigidBody& body) const;
  void pay_for_lift(Body& body);
  void slow(Body& body) const;  // world_bodies.cpp
  void look_after(Body& body);  // world_bodies.cpp

  // world_events.cpp
  void collect(double dt);
  void collect(const btPersistentManifold& manifold, double dt);
  void collect_pair(const btManifoldPoint& point, const Vec3& impulse, BodyId a, BodyId b, double dt);
  ContactEvent event(const Body& body, BodyId other, const Vec3& point, const Vec3& impulse, double dt) const;
  const surface::Surface& surface_of(BodyId id) const {
    return id == floor_body ? *surface : *grounds[id - first_surface_body]->surface;
  }
  void audit(double dt);
};

}  // namespace intaglio::dynamics
