// The state of a World. Its member functions are defined in world.cpp (steps), world_state.cpp (bodies) and
// world_events.cpp (events).
//
// Internal to dynamics/: includes Bullet.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <memory>
#include <optional>
#include <vector>

#include "contact/shape.h"
#include "dynamics/bullet_shape.h"
#include "dynamics/textured_shape.h"
#include "dynamics/world.h"
#include "intaglio/representation.h"

namespace intaglio::dynamics {

// Maps poses between simulation, on the relief that a normal map implies, and display, on the flat floor.
//
// A drawn body is as far above the floor as it is from the implied relief, over the same point of the map,
// and turned back by the map's mean tilt: it neither sinks nor floats, and nothing jumps. World frame;
// microseconds; any thread.
class DrawnFrame {
 public:
  // `relief` lies over the same rectangle as the floor `map`; slopes are local.
  DrawnFrame(const surface::Surface& map, const surface::Surface& relief, const Vec2& mean_slope);

  // From simulated to drawn.
  Pose pose(const contact::Shape& shape, const Pose& simulated) const;
  Vec3 point(const Vec3& simulated) const;
  Vec3 velocity(const Vec3& simulated) const;
  // From drawn to simulated.
  Pose simulated(const contact::Shape& shape, const Pose& drawn) const;
  Vec3 simulated_velocity(const Vec3& drawn) const;

 private:
  const surface::Surface& map_;
  const surface::Surface& relief_;
  Vec2 mean_slope_;
  Quat level_rotation_;  // from the map's mean plane to the floor
};

struct World::State {
  // One of a contact's two bodies.
  struct Side {
    BodyId id = floor_body;
    Vec3 point = Vec3::Zero();        // on its surface
    std::optional<TextureSite> site;  // in its own frame
  };
  struct Contact {
    Side body, other;
    Vec3 normal = Vec3::UnitY();  // towards `body`
    Vec3 impulse = Vec3::Zero();  // on `body`
    std::optional<double> touch_time;

    Contact swapped() const { return {other, body, -normal, -impulse, touch_time}; }
  };
  // A body's contact partner in this step or the last.
  struct Touch {
    BodyId other = floor_body;
    bool was_touching = false, is_touching = false;
    Contact last{};
  };
  struct Body {
    contact::Shape shape;
    std::vector<std::shared_ptr<const surface::Surface>> faces;  // empty in a world without textures
    std::optional<surface::ReliefMesh> skin;                     // likewise
    Pose shape_pose;  // of the shape in Bullet's frame: principal axes round the centre of mass
    BulletShape bullet_shape;
    std::unique_ptr<btRigidBody> rigid;
    double reach = 0;                      // m, of the shape around its centre of mass
    double texel = 0;                      // m, of its own relief; 0: none
    double curvature = 0;                  // 1/m, of a body that rolls: 1 / radius; 0: it slides
    std::optional<Pose> drawn;             // cached while events are emitted
    Vec3 reported_impulse = Vec3::Zero();  // N s, in this step
    Vec3 velocity_before = Vec3::Zero();
    btTransform last_good = btTransform::getIdentity();
    double energy_before = 0;  // J
    unsigned status = 0;
    Motion motion = Motion::free;
    std::optional<btTransform> target;  // of a driven body, at the end of the step
    std::vector<Touch> touches;
    bool touched_ground = false, touched_body = false;  // in this step
    bool was_awake = false;                             // before it: gravity acts on awake bodies only

    bool is_simulated() const { return (status & not_simulated) == 0; }
    bool is_moving() const { return motion == Motion::free && is_simulated() && rigid->isActive(); }
    bool is_textured() const { return skin || !faces.empty(); }
    // Bullet's transform of a body whose shape is at `pose`.
    btTransform rigid_transform(const Pose& pose) const {
      const Quat axes = pose.orientation * shape_pose.orientation.conjugate();
      return to_bullet(Pose{pose.position - axes * shape_pose.position, axes});
    }
    Touch& touch(BodyId other);
  };
  // A textured surface that does not move: the floor, or one beside it.
  struct Ground {
    std::shared_ptr<const surface::Surface> surface;  // on its rectangle, or
    std::optional<surface::ReliefMesh> curved;        // on a base
    std::unique_ptr<TexturedShapeBase> shape;
    btRigidBody rigid;

    Ground(std::shared_ptr<const surface::Surface> s, const Material& material, const WorldOptions& o);
    Ground(const surface::ReliefMesh& relief, const Material& material, const WorldOptions& o,
           double thickness);
    // The rectangle, if it is one.
    const TexturedShape* flat() const {
      return curved ? nullptr : static_cast<const TexturedShape*>(shape.get());
    }

   private:
    void set_material(const Material& material);
  };
  // A TextureSite in the world.
  struct Texture {
    int index = -1;  // of the body's textures; -1: none there
    Vec2 uv = Vec2::Zero();
    Vec3 n_g, n_s;
    // On a moving or curved body: takes a velocity (world) to that along u and v, in metres of the texture.
    std::optional<Eigen::Matrix<double, 2, 3>> sweep{};
  };

  WorldOptions options;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  ContactRecords records{dispatcher};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  std::unique_ptr<Ground> floor;
  std::optional<DrawnFrame> drawn;  // when bodies are not drawn where they are simulated
  double floor_rolling_resistance = 0;
  std::vector<Body> bodies;
  std::vector<std::unique_ptr<Ground>> grounds;
  std::vector<ContactEvent> events;
  double time = 0;
  std::int64_t steps = 0;
  double momentum_residual = 0;

  State(std::unique_ptr<Ground> floor, const Material& material, const WorldOptions& o);
  ~State();

  BodyId id(const btCollisionObject& object) const { return BodyId(object.getUserIndex()); }
  Body& body(BodyId id);
  const Ground& ground(BodyId id) const {
    return id == floor_body ? *floor : *grounds[id - first_surface_body];
  }
  Pose pose(const Body& b) const {
    const Pose rigid = from_bullet(b.rigid->getWorldTransform());
    return {rigid.to_world(b.shape_pose.position), rigid.orientation * b.shape_pose.orientation};
  }
  Pose drawn_pose(const Body& b) const { return drawn ? drawn->pose(b.shape, pose(b)) : pose(b); }
  // Bodies collide without their relief.
  bool is_flattened() const { return options.representation != Representation::relief; }
  // The paper's normal substitution, which does not conserve energy.
  bool is_literal() const {
    return options.representation == Representation::normal && options.normal_method == NormalMethod::literal;
  }

  // world.cpp
  int substeps() const;
  void advance(double dt);
  // Moves each driven body by that share of the way that is left to its target.
  void drive(double share);
  double energy(const btRigidBody& body) const;
  void remove_lift_energy(Body& body);

  // world_state.cpp
  BodyId add(const ShapeBody& body);
  BodyId add(std::unique_ptr<Ground> ground);
  void place(Body& body, const Pose& pose, const Vec3& velocity, const Vec3& angular_velocity);
  void limit_speed(Body& body) const;
  void update_status(Body& body);

  // world_events.cpp
  void collect(double dt);
  void collect(const btPersistentManifold& manifold, double dt);
  void emit_point(const Contact& contact, const Vec3& on_b, double dt);
  // Emits an event if `other` has a texture there, or `body` has; whether either has.
  bool emit_contact(const Contact& contact, double dt);
  void emit_untextured_pair(const Contact& contact, const Vec3& point, double dt);
  void emit_ended(double dt);
  ContactEvent event(Body& body, const Touch& touch, const Vec3& impulse, double dt);
  Vec3 velocity_of(BodyId other, const Vec3& point) const;
  Vec3 contact_velocity(const Body& body, BodyId other) const;
  // The same, computed once for all events of a step.
  const Pose& cached_drawn_pose(Body& body);
  Vec3 drawn_point(Body& body, BodyId other, const Vec3& point);
  Side side(BodyId id, const Vec3& point, const btVector3& local_point, const Vec3& outwards,
            const std::optional<TextureSite>& known) const;
  Texture texture(const Side& side, const Vec3& normal) const;
  void audit(double dt);
};

}  // namespace intaglio::dynamics
