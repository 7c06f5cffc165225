// Rigid bodies on textured surfaces: a Bullet world whose contacts come from the textures of the floor, of
// other ground, flat or on a curved base, and of bodies.
//
// Fixed steps, deterministic: the same bodies and steps give the same motion. One thread at a time. A step
// costs about 3 us a body for Bullet itself, plus the contact query of the representation
// (docs/contact-bench.md). Bullet computes in 32-bit floats: keep the scene within some metres of the origin.
// A step in which a body moves farther than a texel is divided into substeps. Curved grounds and textured
// bodies have their relief in the representation `relief` only; in the others bodies collide without it.
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
  bool report_pairs = false;   // emit events of pairs of bodies without texture, too
};

// How a body moves.
enum class Motion {
  free,    // dynamic
  fixed,   // never: a post, a wall
  driven,  // kinematic, follows World::drive(): a flipper
};

struct SphereBody {
  double radius = 0.05;  // m
  Material material;
  Vec3 position = Vec3::Zero();          // m
  Vec3 velocity = Vec3::Zero();          // m/s
  Vec3 angular_velocity = Vec3::Zero();  // rad/s

  double mass() const;  // kg, solid
};

// A solid body of any contact::Shape, of uniform density. `pose` is that of the shape's frame, wherever its
// centre of mass is; the velocity is that of the centre of mass.
//
// A textured body has reliefs in the shape's frame: `faces` are rectangles on the sides of a Box, with the
// relief cut into it; a `skin` replaces the shape, which is then its base without relief. Other bodies touch
// the relief; two reliefs touch as TexturedShape and CurvedShape do; curved on curved costs some 100 ms a
// touching pair and step (docs/curved.md). Anything deeper than a face's relief plus one texel collides with
// the box.
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

// Bits of World::status() beside those of contact::status (contact/contact_point.h).
inline constexpr unsigned not_simulated = 0x10000;  // stays where it was put: no size, not finite, or lost
inline constexpr unsigned slowed = 0x20000;         // its speed was limited to what contacts can be found for

class World {
 public:
  World(std::shared_ptr<const surface::Surface> floor, const Material& floor_material,
        const WorldOptions& options);
  // On a curved floor, in world coordinates: a bowl, a pipe.
  World(const surface::ReliefMesh& floor, const Material& floor_material, const WorldOptions& options);
  ~World();
  World(World&&) noexcept;

  // Bodies are numbered from 1; 0 is the floor. Positions and velocities are those of the body as drawn.
  BodyId add(const SphereBody& body);
  BodyId add(const ShapeBody& body);
  // One more textured surface that does not move, where its placement says; numbered from
  // first_surface_body. Bodies on it are drawn where they are simulated, also over a normal map.
  BodyId add_surface(std::shared_ptr<const surface::Surface> surface, const Material& material);
  // The same on a curved base; anything deeper under its relief than `thickness` metres is behind it.
  BodyId add_surface(const surface::ReliefMesh& relief, const Material& material,
                     double thickness = std::numeric_limits<double>::infinity());

  // An impulse through the body's centre (N s), from something outside this world: a pen. Wakes the body.
  void push(BodyId body, const Vec3& impulse);
  // The same at a point of the body as drawn, world frame: it turns as well.
  void push(BodyId body, const Vec3& impulse, const Vec3& point);
  // Teleports the body; velocities as for add().
  void put(BodyId body, const Pose& pose, const Vec3& velocity, const Vec3& angular_velocity);
  // Sets where a driven body is at the end of the next step; it pushes others with the speed of that motion.
  void drive(BodyId body, const Pose& pose);

  // One fixed step. Afterwards events() holds its contacts, in order of body.
  void step();

  std::span<const ContactEvent> events() const;
  double time() const;  // s, end of the last step
  std::size_t body_count() const;
  // Where the body is simulated. Over a normal map that is on the relief that the normals imply, while it is
  // drawn, and heard, on the flat floor (DrawnFrame). Everywhere else both are the same.
  Pose pose(BodyId body) const;
  Pose drawn_pose(BodyId body) const;
  // Likewise; what put() takes is the drawn one.
  Vec3 velocity(BodyId body) const;
  Vec3 drawn_velocity(BodyId body) const;
  Vec3 angular_velocity(BodyId body) const;
  // Status bits after the last step: those of contact::status, and the two above.
  unsigned status(BodyId body) const;

  // The largest difference so far between the momentum that a body gained in a step and the impulses reported
  // for it (Eq. 1.1) plus gravity's, N s. Rounding only, unless a contact is lost or counted twice.
  double momentum_residual() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace intaglio::dynamics
