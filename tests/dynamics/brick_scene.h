// The scene in which contact is judged, for tests and for bench/contact: a relief of bricks 4 m a side and
// 8 cm deep with slopes up to 77 degrees, and balls of 10 cm that roll over it, each for itself.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "contact/polyhedron.h"
#include "contact/shape.h"
#include "core/portable_math.h"
#include "dynamics/world.h"
#include "surface/closest.h"
#include "tests/surface/brick_surface.h"

namespace intaglio::tests::brick_scene {

inline constexpr double side = 4, radius = 0.1, gravity = 9.81;

inline std::shared_ptr<const surface::Surface> floor(int size = 512) {
  return brick_surface(size, side);
}

// Neither bounce nor rolling resistance, which would hide faults of the contacts.
inline Material material(double friction = 0.5) {
  Material out;
  out.name = "scene";
  out.friction = friction;
  out.restitution = 0;
  out.rolling_resistance = 0;
  return out;
}

struct NamedShape {
  std::string name;
  contact::Shape shape;
};

// One of each kind, some 10 cm of radius.
inline std::vector<NamedShape> shapes() {
  std::vector<Vec3> corners;
  for (int k = 0; k < 32; ++k) {
    const double y = 1 - (2 * k + 1.0) / 32, angle = k * std::numbers::pi * (3 - std::sqrt(5.0));
    const double across = std::sqrt(1 - y * y);
    corners.push_back(0.15 * Vec3(across * std::cos(angle), 0.6 * y, across * std::sin(angle)));
  }
  // Flat below, to slide on.
  for (Vec3& corner : corners) corner.y() = std::max(corner.y(), -0.06);
  return {{"sphere", contact::Sphere{radius}},
          {"box", contact::Box{{0.15, 0.1, 0.2}}},
          {"hull", contact::ConvexHull{*contact::convex_hull(corners)}},
          {"capsule", contact::Capsule{0.08, 0.12}},
          {"cylinder", contact::Cylinder{0.1, 0.08}}};
}

inline dynamics::ShapeBody body(const contact::Shape& shape, const Vec3& position, double friction = 0.5) {
  dynamics::ShapeBody out;
  out.shape = shape;
  out.material = material(friction);
  out.pose.position = position;
  return out;
}

// Lifts or lowers a centre until the ball is `gap` above the relief.
inline Vec3 above(const surface::Surface& s, Vec3 centre, double gap) {
  for (int n = 0; n < 60; ++n) {
    const double distance = closest_point(s, s.placement().to_local(centre))->distance;
    centre += (radius + gap - distance) * s.placement().n();
  }
  return centre;
}

// Balls a millimetre above the relief, anywhere on its middle, with up to `speed` m/s in any direction.
inline std::vector<dynamics::SphereBody> balls(const surface::Surface& s, int count, double speed = 1,
                                               std::uint64_t seed = 1) {
  Random random(seed);
  std::vector<dynamics::SphereBody> out;
  for (int k = 0; k < count; ++k) {
    dynamics::SphereBody ball;
    ball.radius = radius;
    ball.material = material();
    ball.position =
        above(s, {random.uniform(-0.3, 0.3) * side, 0.2, random.uniform(-0.3, 0.3) * side}, 0.001);
    const double angle = random.uniform(0, 2 * std::numbers::pi), v = random.uniform(0, speed);
    ball.velocity = {v * std::cos(angle), 0, v * std::sin(angle)};
    out.push_back(ball);
  }
  return out;
}

inline dynamics::WorldOptions options(int rate) {
  dynamics::WorldOptions out;
  out.step = 1.0 / rate;
  out.bodies_collide = false;
  return out;
}

inline dynamics::World world(std::shared_ptr<const surface::Surface> s, const dynamics::WorldOptions& options,
                             const std::vector<dynamics::SphereBody>& bodies) {
  dynamics::World out(std::move(s), material(), options);
  for (const dynamics::SphereBody& body : bodies) out.add(body);
  return out;
}

// Kinetic and potential, joules, of a body whose frame is in its centre of mass.
inline double energy(const dynamics::World& world, BodyId id, const dynamics::ShapeBody& body) {
  const contact::MassProperties of = contact::mass_properties(body.shape);
  const Pose pose = world.pose(id);
  const Vec3 spin = pose.orientation.conjugate() * world.angular_velocity(id);
  return body.material.density *
         (0.5 * of.volume * world.velocity(id).squaredNorm() + 0.5 * spin.dot(of.inertia * spin) +
          of.volume * gravity * pose.to_world(of.centre).y());
}
inline double energy(const dynamics::World& world, BodyId id, const dynamics::SphereBody& ball) {
  const double inertia = 0.4 * ball.mass() * ball.radius * ball.radius;
  return 0.5 * ball.mass() * world.velocity(id).squaredNorm() +
         0.5 * inertia * world.angular_velocity(id).squaredNorm() +
         ball.mass() * gravity * world.pose(id).position.y();
}

}  // namespace intaglio::tests::brick_scene
