// Rigid bodies on textured surfaces: a complete world, for programs without a physics engine of their own.
//
//   auto world = intaglio::World::create({.floor = wall}).value();
//   auto ball = world.add(intaglio::Sphere{0.05}, {.material = "steel", .position = {0, 1, 0}}).value();
//   world.run(2.0);
//   for (const intaglio::ContactEvent& e : world.events()) ...     // examples/ball_on_brick.cpp
//
// Fixed steps and deterministic: the same bodies and steps give the same motion and events, to the bit, on
// every machine. A World runs on one thread at a time; what it is given (surfaces, shapes) is shared and
// immutable. SI units, world frame. Computed by Bullet in 32-bit floats: keep the scene within some metres of
// the origin. A body that moves farther than a texel in a step makes the world take smaller steps inside.
// Cost of a step: about 3 us a body, and its contacts (docs/contact-bench.md).
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/event.h"
#include "intaglio/material.h"
#include "intaglio/mesh.h"
#include "intaglio/representation.h"
#include "intaglio/shape.h"
#include "intaglio/surface.h"
#include "intaglio/vec.h"

namespace intaglio {

struct WorldOptions {
  std::variant<Surface, CurvedSurface> floor;         // BodyId 0; a curved one has its relief below its base
  std::optional<MaterialChoice> floor_material = {};  // unset: the texture's own
  // Of rectangles; a curved base has its relief in `relief` and is smooth otherwise.
  Representation representation = Representation::relief;
  ContactMethod method = ContactMethod::closest;
  NormalMethod normal_method = NormalMethod::implied;
  Vec3 gravity = Vec3(0, -9.81, 0);  // m/s^2
  double step = 1.0 / 480;           // s
  bool bodies_collide = true;        // with each other
  int most_substeps = 8;             // of one step, when bodies are fast
  bool report_pairs = false;         // events of bodies without texture that touch each other, too
};

// How a body moves.
enum class Motion {
  free,    // by the forces on it
  fixed,   // never: a post, a wall
  driven,  // where World::drive() puts it, whatever it meets: a flipper
};

// A solid body of uniform density. A textured one has reliefs in the shape's frame: `faces` are rectangles on
// the sides of a Box, into which their relief cuts; a closed `skin` replaces the shape in contacts.
struct BodyOptions {
  MaterialChoice material = "plastic";
  Vec3 position = Vec3::Zero();  // m, of the shape's origin
  Quat orientation = Quat::Identity();
  Vec3 velocity = Vec3::Zero();          // m/s, of the centre of mass
  Vec3 angular_velocity = Vec3::Zero();  // rad/s
  Motion motion = Motion::free;
  std::vector<Surface> faces = {};
  std::optional<CurvedSurface> skin = {};
};

struct GroundOptions {
  std::optional<MaterialChoice> material = {};  // unset: the texture's own
  // m, of a curved one: what is deeper below its relief is behind it.
  double thickness = std::numeric_limits<double>::infinity();
};

// Bits that World::status() adds to those of contact_status.
namespace body_status {
inline constexpr unsigned not_simulated = 1u << 16;  // stays where it was put: no size, not finite, or lost
inline constexpr unsigned slowed = 1u << 17;         // was faster than contacts can be foreseen
}  // namespace body_status

class World {
 public:
  // Errors: a material that is not known; a step that is not above 0.
  static Result<World> create(const WorldOptions& options);
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;
  ~World();

  // Bodies are numbered from 1. Errors: a material that is not known, a shape without size, numbers that are
  // not finite, faces on a shape other than a Box, an open skin.
  Result<BodyId> add(const Shape& shape, const BodyOptions& options = {});
  // One more surface that does not move, where its pose (or mesh) says; numbered from first_surface_body.
  Result<BodyId> add_ground(const Surface& surface, const GroundOptions& options = {});
  Result<BodyId> add_ground(const CurvedSurface& surface, const GroundOptions& options = {});

  // One fixed step; events() then holds its contacts, in order of body.
  void step();
  // As many whole steps as `seconds` need; events() then holds those of all of them.
  void run(double seconds);
  std::span<const ContactEvent> events() const;
  double time() const;  // s, the end of the last step

  // An impulse (N s) from outside this world, through the body's centre or at a world point. Wakes the body.
  void push(BodyId body, const Vec3& impulse);
  void push(BodyId body, const Vec3& impulse, const Vec3& point);
  // Puts a body elsewhere, as if it had been added there.
  void put(BodyId body, const Pose& pose, const Vec3& velocity = Vec3::Zero(),
           const Vec3& angular_velocity = Vec3::Zero());
  // Where a driven body is at the end of the next step; what it meets feels the speed at which it gets there.
  void drive(BodyId body, const Pose& pose);

  std::size_t body_count() const;
  // Where to draw the body. Over a normal map with NormalMethod::implied that is on the flat floor, while it
  // is simulated on the implied relief; everywhere else both poses are the same.
  Pose pose(BodyId body) const;
  Pose simulated_pose(BodyId body) const;
  Vec3 velocity(BodyId body) const;          // m/s
  Vec3 angular_velocity(BodyId body) const;  // rad/s
  double mass(BodyId body) const;            // kg
  // Bits of contact_status and body_status as of the last step.
  unsigned status(BodyId body) const;
  // The worst disagreement so far between the momentum that a body gained in a step and the impulses reported
  // for it (Eq. 1.1) plus gravity's, N s: rounding only, when no contact is lost or counted twice.
  double momentum_residual() const;

 private:
  struct Impl;
  explicit World(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

}  // namespace intaglio
