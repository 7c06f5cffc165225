#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "intaglio/representation.h"
#include "tests/dynamics/brick_scene.h"

using namespace intaglio;
using namespace intaglio::dynamics;
namespace scene = intaglio::tests::brick_scene;
namespace status = intaglio::contact::status;

namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();

ShapeBody body_at(const Vec3& position, const Vec3& velocity = Vec3::Zero(),
                  contact::Shape shape = contact::Sphere{scene::radius}) {
  ShapeBody out;
  out.shape = std::move(shape);
  out.material = scene::material();
  out.pose.position = position;
  out.velocity = velocity;
  return out;
}

WorldOptions scene_options(Representation representation) {
  WorldOptions out = scene::options(60);
  out.representation = representation;
  return out;
}

// Runs a world with that body and a valid one for a second; all status bits of the first.
unsigned status_after(const ShapeBody& body, Representation representation, int steps = 60) {
  World world(scene::floor(128), scene::material(), scene_options(representation));
  world.add(body);
  const double height = representation == Representation::relief ? 0.2 : 0.1;
  world.add(body_at({0.5, height, 0.5}));
  unsigned seen = 0;
  for (int k = 0; k < steps; ++k) {
    world.step();
    seen |= world.status(1);
    for (BodyId id = 1; id <= 2; ++id) {
      CHECK(world.pose(id).position.allFinite());
      CHECK(world.drawn_pose(id).position.allFinite());
      CHECK(world.velocity(id).allFinite());
      CHECK(world.angular_velocity(id).allFinite());
    }
    for (const ContactEvent& e : world.events()) {
      CHECK(e.impulse.allFinite());
      CHECK(e.point.allFinite());
    }
  }
  CHECK(world.status(2) == 0);
  CHECK(world.pose(2).position.y() > -0.2);
  return seen;
}

}  // namespace

TEST_CASE("bodies that cannot be simulated report it and affect no other") {
  for (const auto r : {Representation::flat, Representation::normal, Representation::relief}) {
    const Vec3 here(-0.5, 0.2, 0);
    CHECK((status_after(body_at(here, {0, 0, 0}, contact::Sphere{0}), r) & status::no_size) != 0);
    CHECK((status_after(body_at(here, {0, 0, 0}, contact::Sphere{nan_value}), r) & status::no_size) != 0);
    CHECK((status_after(body_at(here, {0, 0, 0}, contact::Box{Vec3(0.1, 0, 0.1)}), r) & status::no_size) !=
          0);
    CHECK((status_after(body_at(here, {0, 0, 0}, contact::Compound{}), r) & status::no_size) != 0);
    CHECK((status_after(body_at(here, {0, 0, 0}, contact::ConvexHull{}), r) & status::no_size) != 0);
    CHECK((status_after(body_at({nan_value, 0, 0}), r) & status::bad_pose) != 0);
    CHECK((status_after(body_at({0, infinite, 0}), r) & status::bad_pose) != 0);
    CHECK((status_after(body_at(here, {0, nan_value, 0}), r) & status::bad_pose) != 0);
    ShapeBody no_turn = body_at(here);
    no_turn.pose.orientation.coeffs().setZero();
    CHECK((status_after(no_turn, r) & status::bad_pose) != 0);
    CHECK((status_after(body_at({1e6, 0, 0}), r) & (status::far | not_simulated)) ==
          (status::far | not_simulated));
    CHECK((status_after(body_at({0, 300, 0}), r) & status::far) != 0);
  }
}

TEST_CASE("a body beyond the edge falls and reports it") {
  for (const auto r : {Representation::flat, Representation::normal, Representation::relief}) {
    CHECK((status_after(body_at({2.5, 0.2, 0}), r) & status::off_edge) != 0);
    World world(scene::floor(128), scene::material(), scene_options(r));
    world.add(body_at({2.5, 0.2, 0}));
    for (int k = 0; k < 60; ++k) world.step();
    CHECK(world.pose(1).position.y() < -3);
  }
}

TEST_CASE("a body under the relief reports it, comes up, and is not thrown") {
  World world(scene::floor(128), scene::material(), scene_options(Representation::relief));
  world.add(body_at({0.3, -0.25, 0.2}));
  world.step();
  CHECK((world.status(1) & status::under) != 0);
  double highest = -1;
  for (int k = 0; k < 240; ++k) {
    world.step();
    highest = std::max(highest, world.pose(1).position.y());
  }
  CHECK(world.status(1) == 0);
  CHECK(world.pose(1).position.y() > 0);
  CHECK(highest < 0.11);
}

TEST_CASE("enormous speeds do not go through the floor") {
  for (const auto r : {Representation::flat, Representation::normal, Representation::relief}) {
    CHECK((status_after(body_at({-0.5, 0.5, 0}, {0, -1e4, 0}), r) & slowed) != 0);
    CHECK((status_after(body_at({-0.5, 0.5, 0}, {1e12, -1e12, 1e12}), r) & slowed) != 0);
    for (const double speed : {5.0, 20.0, 60.0, 400.0, 1e4, 1e30}) {
      World world(scene::floor(128), scene::material(), scene_options(r));
      world.add(body_at({-0.5, 0.5, 0}, {0, -speed, 0}));
      world.add(body_at({-0.5, 0.3, 0.5}, {0.2 * speed, -speed, 0}));
      for (int k = 0; k < 30; ++k) world.step();
      CHECK(world.pose(1).position.y() > 0);
      if ((world.status(2) & status::off_edge) == 0) CHECK(world.pose(2).position.y() > 0);
    }
    ShapeBody spinning = body_at({-0.5, 0.2, 0});
    spinning.angular_velocity = {1e9, -1e20, 3};
    CHECK((status_after(spinning, r) & slowed) != 0);
  }
}
