// What a World holds. Internal to dynamics/: includes Bullet.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <memory>
#include <optional>
#include <vector>

#include "contact/shape.h"
#include "dynamics/bullet_shape.h"
#include "dynamics/drawn.h"
#include "dynamics/textured_shape.h"
#include "dynamics/world.h"
#include "intaglio/representation.h"

namespace intaglio::dynamics {

struct World::State {
  // Whom a body touched: now, or in the step before.
  struct Touch {
    BodyId other = floor_body;
    bool before = false, now = false;
    Vec3 point = Vec3::Zero(), normal = Vec3::UnitY();  // where, the last time
  };
  struct Body {
    contact::Shape shape;
    std::vector<std::shared_ptr<const surface::Surface>> faces;  // empty in a world without textures
    std::optional<surface::ReliefMesh> skin;                     // likewise
    Pose held;  // of the shape in Bullet's frame: principal axes round the centre of mass
    BulletShape bullet_shape;
    std::unique_ptr<btRigidBody> rigid;
    double reach = 0;            // m, of the shape around its centre of mass
    double texel = 0;            // m, of its own relief; 0: none
    double bend = 0;             // 1/m, of what rolls: 1 / radius; 0: it slides
    std::optional<Pose> drawn;   // while events are told
    Vec3 gained = Vec3::Zero();  // N s, reported in this step
    Vec3 velocity_before = Vec3::Zero();
    btTransform last_good = btTransform::getIdentity();
    double energy_before = 0;  // J
    unsigned status = 0;
    Motion motion = Motion::free;
    std::optional<btTransform> goal;  // of one that is driven, at the end of the step
    std::vector<Touch> touches;
    bool on_ground = false, met_another = false;  // in this step
    bool was_awake = false;                       // before it: Bullet lets gravity pull on no other

    bool is_simulated() const { return (status & not_simulated) == 0; }
    bool is_moving() const { return motion == Motion::free && is_simulated() && rigid->isActive(); }
    bool is_textured() const { return skin || !faces.empty(); }
    Touch& touch(BodyId other);
  };
  // A textured surface that does not move: the floor, or one beside it.
  struct Ground {
    std::shared_ptr<const surface::Surface> surface;  // on its rectangle, or
    std::optional<surface::ReliefMesh> curved;        // on a base
    std::unique_ptr<TouchableShape> shape;
    btRigidBody rigid;

    Ground(std::shared_ptr<const surface::Surface> s, const Material& material, const WorldOptions& o);
    Ground(const surface::ReliefMesh& relief, const Material& material, const WorldOptions& o,
           double thickness);
    // The rectangle, where there is one.
    const TexturedShape* flat() const {
      return curved ? nullptr : static_cast<const TexturedShape*>(shape.get());
    }

   private:
    void is_made_of(const Material& material);
  };
  // What a contact with something textured is one with.
  struct Texture {
    Vec2 uv = Vec2::Zero();
    Vec3 n_g, n_s;
    int index = 0;  // of the body's textures; -1: none there
    // Of what moves or is curved: how fast a velocity (world) sweeps along u and v, in metres of the texture.
    std::optional<Eigen::Matrix<double, 2, 3>> sweep{};
  };

  WorldOptions options;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  std::unique_ptr<Ground> floor;
  std::optional<Drawn> drawn;  // when what is simulated is not what is drawn
  double floor_rolling_resistance = 0;
  std::vector<Body> bodies;
  std::vector<std::unique_ptr<Ground>> grounds;
  std::vector<ContactEvent> events;
  double time = 0;
  std::int64_t steps = 0;
  double momentum_residual = 0;

  State(std::unique_ptr<Ground> floor, const Material& material, const WorldOptions& o);
  ~State();

  Body& body(BodyId id);
  // world_state.cpp
  BodyId add(const ShapeBody& body);
  BodyId add(std::unique_ptr<Ground> ground);
  void place(Body& body, const Pose& pose, const Vec3& velocity, const Vec3& angular_velocity);
  BodyId id(const btCollisionObject& object) const { return static_cast<BodyId>(object.getUserIndex()); }
  Pose pose(const Body& b) const {
    const Pose whole = from_bullet(b.rigid->getWorldTransform());
    return {whole.to_world(b.held.position), whole.orientation * b.held.orientation};
  }
  Pose drawn_pose(const Body& b) const { return drawn ? drawn->pose(b.shape, pose(b)) : pose(b); }
  void advance(double dt);
  // Each driven body goes that share of the way that is left to it.
  void drive(double share);
  int substeps() const;
  // The paper's normal substitution, which knows no energy.
  bool is_literal() const {
    return options.representation == Representation::normal && options.normal_method == NormalMethod::literal;
  }
  double energy(const btRigidBody& body) const;
  void pay_for_lift(Body& body);
  void slow(Body& body) const;  // world_state.cpp
  void look_after(Body& body);  // world_state.cpp

  // world_events.cpp
  void collect(double dt);
  void collect(const btPersistentManifold& manifold, double dt);
  void collect_point(const btManifoldPoint& point, const Vec3& impulse, BodyId a, BodyId b, double dt);
  // Tells that `who` touches the texture of `other`, or that with its own; false where there is none.
  bool told(BodyId who, BodyId other, const Vec3& on, const Vec3& normal, const Vec3& impulse, double dt);
  void collect_pair(const Vec3& point, const Vec3& normal, const Vec3& impulse, BodyId a, BodyId b,
                    double dt);
  void collect_ends(double dt);
  ContactEvent event(Body& body, const Touch& touch, const Texture& texture, const Vec3& impulse, double dt);
  Vec3 velocity_of(BodyId other, const Vec3& point) const;
  Vec3 contact_velocity(const Body& body, BodyId other) const;
  // drawn_pose(), and where one of its points is drawn, once looked up for all events of a step.
  const Pose& told_pose(Body& body);
  Vec3 told_point(Body& body, BodyId other, const Vec3& point);
  bool is_bare() const { return options.representation != Representation::relief; }
  const Ground& ground(BodyId id) const {
    return id == floor_body ? *floor : *grounds[id - first_surface_body];
  }
  // Nothing where what is touched has no texture.
  std::optional<Texture> texture(BodyId other, const Vec3& point, const Vec3& normal) const;
  std::optional<Texture> face_texture(const Body& body, const Vec3& point, const Vec3& normal) const;
  // Of the body itself, where it is touched against `normal`, if the contact sweeps over it.
  std::optional<Texture> own_texture(const Body& body, const Vec3& point, const Vec3& normal) const;
  Texture curved_texture(const surface::ReliefMesh& relief, const Pose& at, const Vec3& point,
                         const Vec3& normal, double reach) const;
  void audit(double dt);
};

// What a body with reliefs of its own (ShapeBody) is to Bullet, and what it weighs.
//
// Internal to dynamics/: includes Bullet.

// With what its reliefs take away: of a face the mean depth, of a skin what is between corners of its base.
// No volume where the skin is open.
contact::MassProperties mass_properties(const ShapeBody& body);
// A bound of how far any of its points is from the origin, m.
double reach(const ShapeBody& body);
// The scale of its own detail, m; 0 without.
double texel(const ShapeBody& body);

// Its reliefs, round a box that is set back by their depth, in the frame of a body that holds it at `held`.
BulletShape to_bullet(const ShapeBody& body, const Pose& held);

// A curved base without its relief.
surface::ReliefMesh bare(const surface::ReliefMesh& relief);

}  // namespace intaglio::dynamics
