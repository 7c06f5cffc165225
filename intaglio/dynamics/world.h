// Rigid bodies on one textured surface: a Bullet world whose contacts come from the texture.
//
// Fixed steps, deterministic: the same bodies and steps give the same motion. Not thread-safe; one thread at
// a time. Cost of a step: about 3 us a body for Bullet itself, plus the contact query of its representation
// (contact/relief.h). Bullet computes in 32-bit floats: keep the scene within some metres of the origin.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "intaglio/core/event.h"
#include "intaglio/core/material.h"
#include "intaglio/core/representation.h"
#include "intaglio/surface/surface.h"

namespace intaglio::dynamics {

// How contacts with a relief are found (contact/relief.h).
enum class ContactMethod {
  closest,      // ours: closest features, true penetration
  directional,  // the paper's: height maps compared along n_g, §1.3.1
};

struct WorldOptions {
  Representation representation = Representation::relief;
  ContactMethod method = ContactMethod::closest;
  Vec3 gravity = Vec3(0, -9.81, 0);  // m/s^2
  double step = 1.0 / 480;           // s
};

struct SphereBody {
  double radius = 0.05;  // m
  Material material;
  Vec3 position = Vec3::Zero();          // m
  Vec3 velocity = Vec3::Zero();          // m/s
  Vec3 angular_velocity = Vec3::Zero();  // rad/s

  double mass() const;  // kg, solid
};

class World {
 public:
  World(std::shared_ptr<const surface::Surface> floor, const Material& floor_material,
        const WorldOptions& options);
  ~World();

  // Bodies are numbered from 1; 0 is the floor.
  BodyId add(const SphereBody& body);

  // One fixed step. Afterwards events() holds its contacts, in order of body.
  void step();

  std::span<const ContactEvent> events() const;
  double time() const;  // s, end of the last step
  std::size_t body_count() const;
  Pose pose(BodyId body) const;
  Vec3 velocity(BodyId body) const;
  Vec3 angular_velocity(BodyId body) const;

  // The worst disagreement so far between the momentum a body gained in a step and the impulses reported for
  // it (Eq. 1.1) plus gravity's, N s. Rounding only, when no contact is lost or counted twice.
  double momentum_residual() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace intaglio::dynamics
