// Bodies that are fixed or driven, surfaces beside the floor, impacts between bodies.
#include <doctest/doctest.h>

#include <cmath>

#include "dynamics/world.h"
#include "intaglio/representation.h"

using namespace intaglio;
using namespace intaglio::dynamics;

namespace {

std::shared_ptr<const surface::Surface> plate(const Vec3& centre) {
  surface::Texels t;
  t.width = t.height = 16;
  t.depth.assign(256, 0.0f);
  t.normal.assign(256, Vec3::UnitZ());
  return std::make_shared<const surface::Surface>(
      std::move(t), surface::Placement(centre, Quat::Identity(), 1, 1), 0.01, surface::Edge::clamp);
}

SphereBody ball(const Vec3& position) {
  SphereBody body;
  body.material = *find_material("steel");
  body.position = position;
  body.radius = 0.05;
  return body;
}

WorldOptions flat_options(bool pairs = true) {
  WorldOptions options;
  options.representation = Representation::flat;
  options.report_pairs = pairs;
  return options;
}

}  // namespace

TEST_CASE("a ball rests on a second surface at its height, and its events name that surface") {
  const Material stone = *find_material("stone");
  World world(plate(Vec3::Zero()), stone, flat_options());
  const BodyId shelf = world.add_surface(plate({1.2, 0.4, 0}), stone);
  CHECK(shelf == first_surface_body);
  CHECK(is_surface(shelf));
  const BodyId low = world.add(ball({0, 0.06, 0})), high = world.add(ball({1.2, 0.46, 0}));
  bool named = true;
  for (int k = 0; k < 480; ++k) {
    world.step();
    for (const ContactEvent& e : world.events()) {
      named = named && e.other == (e.body == low ? floor_body : shelf);
      if (e.body == high) named = named && (e.uv - Vec2(0.5, 0.5)).norm() < 0.01;
    }
  }
  CHECK(named);
  CHECK(world.pose(low).position.y() == doctest::Approx(0.05).epsilon(0.01));
  CHECK(world.pose(high).position.y() == doctest::Approx(0.45).epsilon(0.01));
}

TEST_CASE("a driven paddle throws a ball at its own speed or more; a fixed post stays") {
  World world(plate(Vec3::Zero()), *find_material("stone"), flat_options());
  ShapeBody paddle;
  paddle.shape = contact::Box{{0.02, 0.05, 0.1}};
  paddle.material = *find_material("steel");
  paddle.pose.position = {-0.2, 0.06, 0};
  paddle.motion = Motion::driven;
  const BodyId driven = world.add(paddle);
  paddle.pose.position = {0.4, 0.06, 0};
  paddle.motion = Motion::fixed;
  const BodyId post = world.add(paddle);
  const BodyId thrown = world.add(ball({0, 0.05, 0}));
  double fastest = 0;
  int blows = 0;
  for (int k = 0; k < 240; ++k) {
    const double x = std::min(-0.2 + 1.0 * k / 480, 0.0);
    world.drive(driven, {{x, 0.06, 0}, Quat::Identity()});
    world.step();
    fastest = std::max(fastest, world.velocity(thrown).x());
    for (const ContactEvent& e : world.events())
      if (e.other == driven || e.other == post) {
        ++blows;
        CHECK(e.body == thrown);
        CHECK(e.impulse.x() * (e.other == driven ? 1 : -1) > 0);
      }
  }
  CHECK(fastest > 0.99);
  CHECK(fastest < 2.01);
  CHECK(blows >= 2);
  CHECK((world.pose(post).position - Vec3(0.4, 0.06, 0)).norm() < 1e-7);
  CHECK(world.pose(driven).position.x() == doctest::Approx(0).epsilon(1e-6));
}

TEST_CASE("a push at a point turns a body; a push through the middle does not") {
  WorldOptions options = flat_options();
  options.gravity = Vec3::Zero();
  World world(plate(Vec3::Zero()), *find_material("stone"), options);
  const BodyId a = world.add(ball({0, 0.5, 0})), b = world.add(ball({0.5, 0.5, 0}));
  world.push(a, {0, 0, 0.1}, {0, 0.55, 0});
  world.push(b, {0, 0, 0.1}, {0.5, 0.5, 0});
  world.step();
  CHECK(world.angular_velocity(a).x() > 0.1);
  CHECK(world.angular_velocity(b).norm() < 1e-6);
  CHECK((world.velocity(a) - world.velocity(b)).norm() < 1e-6);
  world.put(a, {{0.2, 0.3, 0.1}, Quat::Identity()}, {1, 0, 0}, Vec3::Zero());
  CHECK((world.pose(a).position - Vec3(0.2, 0.3, 0.1)).norm() < 1e-6);
  CHECK((world.velocity(a) - Vec3::UnitX()).norm() < 1e-6);
  CHECK(world.angular_velocity(a).norm() < 1e-6);
}
