// Rigid bodies on textured surfaces: a Bullet world whose contacts come from the textures, of the floor and
// other ground, flat or on a curved base, and of bodies.
//
// Fixed steps, deterministic: the same bodies and steps give the same motion. Not thread-safe; one thread at
// a time. Cost of a step: about 3 us a body for Bullet itself, plus the contact query of its representation
// (docs/contact-bench.md). Bullet computes in 32-bit floats: keep the scene within some metres of the origin.
// A body that moves farther than a texel in a step makes the world take smaller ones inside. Curved bases and
// bodies have their relief in the representation `relief`; in the others they are bare.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "contact/contact_point.h"
#include "contact/shape.h"
#include "dynamics/contact_options.h"
#include "intaglio/event.h"
#include "intaglio/material.h"
#include "intaglio/representation.h"
#include "mesh/relief_mesh.h"
#include "surface/surface.h"

namespace intaglio::dynamics {

struct WorldOptions {
  Representation representation = Representation::relief;
  ContactMethod method = ContactMethod::closest;
  Vec3 gravity = Vec3(0, -9.81, 0);  // m/s^2
  double step = 1.0 / 480;           // s
  NormalMethod normal_method = NormalMethod::implied;
  bool bodies_collide = true;  // with each other
  int most_substeps = 8;       // of one step, when bodies are fast
  bool report_pairs = false;   // events of bodies without texture that touch each other too
};

// How a body comes to move.
enum class Motion {
  free,    // by what acts on it
  fixed,   // never: a post, a wall
  driven,  // as World::drive says, whatever it meets: a flipper
};

struct SphereBody {
  double radius = 0.05;  // m
  Material material;
  Vec3 position = Vec3::Zero();          // m
  Vec3 velocity = Vec3::Zero();          // m/s
  Vec3 angular_velocity = Vec3::Zero();  // rad/s

  double mass() const;  // kg, solid
};

// A solid body of any shape that contact/ knows, of even density. `pose` is that of the shape's frame,
// wherever its centre of mass is; the velocity is that of the centre of mass.
//
// A textured body has reliefs in the shape's frame: `faces` are rectangles on the sides of a Box, their
// relief goes into it; a `skin` is met in place of the shape, which is then what it is without relief. Where
// Bullet's own shapes meet such a body they meet its relief; two reliefs meet as TexturedShape and
// CurvedShape do; curved on curved costs some 100 ms a touching pair and step (docs/curved.md). What of a
// face is deeper in than its relief and a texel is the box's matter.
struct ShapeBody {
  contact::Shape shape;
  std::vector<std::shared_ptr<const surface::Surface>> faces;
  std::optional<surface::ReliefMesh> skin;  // closed: an open one has no inside, and is not simulated
  Material material;
  Pose pose;
  Vec3 velocity = Vec3::Zero();          // m/s
  Vec3 angular_velocity = Vec3::Zero();  // rad/s
  Motion motion = Motion::free;

  double mass() const;  // kg
};

// What World::status adds to the bits of contact::status (contact/contact_point.h).
inline constexpr unsigned not_simulated = 1u
                                          << 16;  // it stays where it was put: no size, not finite, or lost
inline constexpr unsigned slowed = 1u << 17;      // it was faster than contacts can be foreseen

class World {
 public:
  World(std::shared_ptr<const surface::Surface> floor, const Material& floor_material,
        const WorldOptions& options);
  // On a curved floor, in world coordinates: a bowl, a pipe. The relief is what is below its base.
  World(const surface::ReliefMesh& floor, const Material& floor_material, const WorldOptions& options);
  ~World();
  World(World&&) noexcept;

  // Bodies are numbered from 1; 0 is the floor. Positions and velocities are those of the body as drawn.
  BodyId add(const SphereBody& body);
  BodyId add(const ShapeBody& body);
  // One more textured surface that does not move, where its placement says; numbered from
  // first_surface_body. Bodies on it are drawn where they are simulated, also over a normal map.
  BodyId add_surface(std::shared_ptr<const surface::Surface> surface, const Material& material);
  // The same on a curved base; what is under its relief by more than `thickness` metres is behind it.
  BodyId add_surface(const surface::ReliefMesh& relief, const Material& material,
                     double thickness = std::numeric_limits<double>::infinity());

  // An impulse through the body's centre (N s), from something outside this world: a pen. Wakes the body.
  void push(BodyId body, const Vec3& impulse);
  // The same at a point of the body as drawn, world frame: it turns as well.
  void push(BodyId body, const Vec3& impulse, const Vec3& point);
  // Somewhere else, as if it had been added there.
  void put(BodyId body, const Pose& pose, const Vec3& velocity, const Vec3& angular_velocity);
  // Where a driven body is at the end of the next step; what it meets feels the speed at which it gets there.
  void drive(BodyId body, const Pose& pose);

  // One fixed step. Afterwards events() holds its contacts, in order of body.
  void step();

  std::span<const ContactEvent> events() const;
  double time() const;  // s, end of the last step
  std::size_t body_count() const;
  // Where the body is simulated. Over a normal map that is on the relief that the normals imply; it is drawn,
  // and heard, on the flat floor (drawn.h). Everywhere else both are the same.
  Pose pose(BodyId body) const;
  Pose drawn_pose(BodyId body) const;
  // Likewise; what put() takes is the drawn one.
  Vec3 velocity(BodyId body) const;
  Vec3 drawn_velocity(BodyId body) const;
  Vec3 angular_velocity(BodyId body) const;
  // What is the matter with a body as of the last step: bits of contact::status, and the two above.
  unsigned status(BodyId body) const;

  // The worst disagreement so far between the momentum a body gained in a step and the impulses reported for
  // it (Eq. 1.1) plus gravity's, N s. Rounding only, when no contact is lost or counted twice.
  double momentum_residual() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace intaglio::dynamics
