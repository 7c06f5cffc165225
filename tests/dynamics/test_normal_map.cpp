#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/dynamics/brick_scene.h"

using namespace intaglio;
using namespace intaglio::dynamics;
namespace scene = intaglio::tests::brick_scene;

namespace {

WorldOptions normals(int rate) {
  WorldOptions out = scene::options(rate);
  out.representation = Representation::normal;
  return out;
}

SphereBody ball_at(const Vec3& position) {
  SphereBody ball;
  ball.radius = scene::radius;
  ball.material = scene::material();
  ball.position = position;
  return ball;
}

// Normals of slope tan(degrees) that fall towards `heading`, on a square of 4 m.
std::shared_ptr<const surface::Surface> tilted(double degrees, double heading) {
  const double slope = std::tan(degrees * std::numbers::pi / 180);
  return tests::made_surface(
      32, [](Vec2) { return 0.0; },
      [=](Vec2) { return Vec3(slope * std::cos(heading), slope * std::sin(heading), 1); }, 0.02,
      tests::flat_placement(scene::side));
}

// Parallel valleys of a sine whose steepest normals lean by `degrees`.
std::shared_ptr<const surface::Surface> valleys(double degrees, int count, int texels = 256) {
  const double steepest = std::tan(degrees * std::numbers::pi / 180);
  return tests::made_surface(
      texels, [](Vec2) { return 0.0; },
      [=](Vec2 uv) { return Vec3(-steepest * std::cos(2 * std::numbers::pi * count * uv.x()), 0, 1); }, 0.02,
      tests::flat_placement(scene::side));
}

}  // namespace

TEST_CASE("T8: on a uniformly tilted normal map a ball rolls as on the slope, and neither sinks nor slips") {
  for (const double degrees : {2.0, 5.0, 15.0, 30.0, 45.0}) {
    for (const double heading : {0.0, 0.6}) {
      const auto map = tilted(degrees, heading);
      World world(map, scene::material(), normals(240));
      world.add(ball_at({0, scene::radius, 0}));
      double sink = 0, slip = 0;
      constexpr double duration = 0.5;
      for (int k = 0; k < 240 * duration; ++k) {
        world.step();
        sink = std::max(sink, std::abs(world.drawn_pose(1).position.y() - scene::radius));
      }
      const double theta = degrees * std::numbers::pi / 180;
      const Vec3 n_s = map->world_normal({0.5, 0.5});
      const Vec3 velocity = world.velocity(1);
      slip = (velocity + world.angular_velocity(1).cross(-scene::radius * n_s)).norm() / velocity.norm();
      const double along = Vec2(velocity.x(), velocity.z()).norm() / duration;
      const double expected = 5.0 / 7 * scene::gravity * std::sin(theta) * std::cos(theta);
      MESSAGE(degrees << " degrees: acceleration " << along / expected << " of 5/7 g sin cos, sink "
                      << 1000 * sink << " mm, slip " << slip);
      CHECK(std::abs(along / expected - 1) < 0.02);
      CHECK(std::atan2(-velocity.z(), velocity.x()) == doctest::Approx(heading).epsilon(0.01));
      CHECK(sink <= 1e-3);
      CHECK(slip < 0.02);
    }
  }
}

TEST_CASE("T9: a ball between normals of 60 to 75 degrees does not spin in place") {
  for (const double degrees : {60.0, 67.0, 75.0}) {
    for (const int count : {4, 16}) {
      World world(valleys(degrees, count), scene::material(), normals(240));
      for (int k = 0; k < 10; ++k) world.add(ball_at({-0.5 + 0.11 * k, scene::radius, 0.1 * k}));
      double spinning = 0, longest = 0;
      for (int n = 0; n < 240 * 6; ++n) {
        world.step();
        for (BodyId id = 1; id <= 10; ++id) {
          const double rim = world.angular_velocity(id).norm() * scene::radius;
          const double v = world.velocity(id).norm();
          spinning = rim > 0.05 && v < 0.1 * rim ? spinning + 1.0 / 240 : 0;
          longest = std::max(longest, spinning);
        }
      }
      double left = 0;
      for (BodyId id = 1; id <= 10; ++id) left = std::max(left, world.angular_velocity(id).norm());
      MESSAGE(degrees << " degrees, " << count << " valleys: spun in place for " << longest
                      << " s at most; spin left after 6 s: " << left << " rad/s");
      CHECK(longest < 0.1);
    }
  }
}

TEST_CASE(
    "T10: balls on a normal map of bricks gain no energy against the implied height, and none is lost") {
  const auto s = scene::floor(tests::poses(256, 512));
  const int count = tests::poses(20, 100);
  World world(s, scene::material(), normals(60));
  Random random(3);
  std::vector<SphereBody> balls;
  for (int k = 0; k < count; ++k) {
    balls.push_back(ball_at({random.uniform(-1.2, 1.2), scene::radius, random.uniform(-1.2, 1.2)}));
    world.add(balls.back());
  }
  std::vector<double> least;
  double risen = 0;
  const int steps = 60 * tests::poses(6, 30);
  for (int n = 0; n < steps; ++n) {
    world.step();
    for (int k = 0; k < count; ++k) {
      const double e = scene::energy(world, static_cast<BodyId>(k + 1), balls[std::size_t(k)]);
      if (n == 0) least.push_back(e);
      risen = std::max(risen, e - least[std::size_t(k)]);
      least[std::size_t(k)] = std::min(least[std::size_t(k)], e);
    }
  }
  int lost = 0;
  double off = 0;
  for (int k = 0; k < count; ++k) {
    const double height = world.drawn_pose(static_cast<BodyId>(k + 1)).position.y();
    off = std::max(off, std::abs(height - scene::radius));
    lost += height > 0 && height < 2 * scene::radius ? 0 : 1;
  }
  const double mgr = balls[0].mass() * scene::gravity * scene::radius;
  MESSAGE("energy rose by " << risen / mgr << " m g r at most; " << lost << " of " << count
                            << " lost; drawn within " << 1000 * off << " mm of the floor");
  CHECK(risen <= 1e-3 * mgr);
  CHECK(lost == 0);
  CHECK(off < 1e-3);
}
