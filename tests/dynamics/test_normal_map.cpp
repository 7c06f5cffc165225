#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "contact/surface_contacts.h"
#include "core/portable_math.h"
#include "intaglio/representation.h"
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

SphereBody scene_ball(const Vec3& position) {
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
      world.add(scene_ball({0, scene::radius, 0}));
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

TEST_CASE("T9: a ball between normals of 60 to 75 degrees does not spin in place" *
          doctest::test_suite("statistics")) {
  for (const double degrees : {60.0, 67.0, 75.0}) {
    for (const int count : {4, 16}) {
      World world(valleys(degrees, count), scene::material(), normals(240));
      for (int k = 0; k < 10; ++k) world.add(scene_ball({-0.5 + 0.11 * k, scene::radius, 0.1 * k}));
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

TEST_CASE("T10: bodies on a normal map of bricks gain no energy against the implied height; none is lost" *
          doctest::test_suite("statistics")) {
  const auto s = scene::floor(tests::quick_or_slow(128, 512));
  const int count = tests::poses(10, 100), steps = 60 * tests::poses(4, 30);
  for (const scene::NamedShape& named : scene::shapes()) {
    World world(s, scene::material(), normals(60));
    Random random(3);
    ShapeBody body = scene::body(named.shape, {0, 1, 0});
    if (std::holds_alternative<contact::Capsule>(named.shape))
      body.pose.orientation = Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitZ());
    body.pose.position.y() -= contact::flat_contacts(*s, body.shape, body.pose, 2).points[0].distance;
    for (int k = 0; k < count; ++k) {
      ShapeBody added = body;
      added.pose.position += Vec3(random.uniform(-1.2, 1.2), 0, random.uniform(-1.2, 1.2));
      world.add(added);
    }
    std::vector<double> least(std::size_t(count), 1e9);
    double risen = 0;
    for (int n = 0; n < steps; ++n) {
      world.step();
      for (std::size_t k = 0; k < least.size(); ++k) {
        const double e = scene::energy(world, BodyId(k + 1), body);
        risen = std::max(risen, e - least[k]);
        least[k] = std::min(least[k], e);
      }
    }
    int lost = 0, awake = 0;
    for (BodyId id = 1; id <= BodyId(count); ++id) {
      const double height = world.drawn_pose(id).position.y();
      lost += height > 0.03 && height < 0.3 ? 0 : 1;
      awake += world.velocity(id).norm() > 0 ? 1 : 0;
    }
    const double mgr = body.mass() * scene::gravity * scene::radius;
    MESSAGE(named.name << ": energy rose by " << risen / mgr << " m g r at most; " << lost << " of " << count
                       << " lost; " << awake << " not asleep");
    CHECK(risen <= 1e-3 * mgr);
    CHECK(lost == 0);
  }
}
