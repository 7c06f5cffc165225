#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "contact/surface_contacts.h"
#include "tests/dynamics/brick_scene.h"

using namespace intaglio;
using namespace intaglio::dynamics;
namespace scene = intaglio::tests::brick_scene;

namespace {

// A relief whose texels are equally deep: flat, but searched cell by cell.
std::shared_ptr<const surface::Surface> even_relief() {
  return tests::made_surface(
      512, [](Vec2) { return 0.5; }, [](Vec2) { return Vec3::UnitZ(); }, 0.02 * scene::side,
      tests::flat_placement(scene::side));
}

}  // namespace

TEST_CASE("T2: without friction bodies slide over flat relief in any direction as over glass" *
          doctest::test_suite("statistics")) {
  const auto s = even_relief();
  const double ground = -0.01 * scene::side;
  const int directions = tests::poses(8, 64);
  for (const scene::NamedShape& named : scene::shapes()) {
    double hop = 0, loss = 0, spin = 0;
    for (int k = 0; k < directions; ++k) {
      const double angle = 2 * std::numbers::pi * k / directions;
      World world(s, scene::material(0), scene::options(60));
      ShapeBody body = scene::body(named.shape, {0.013, 0.5, -0.021}, 0);
      // A capsule slides lying down.
      if (std::holds_alternative<contact::Capsule>(named.shape))
        body.pose.orientation = Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitZ());
      const auto apart = contact::relief_contacts(*s, body.shape, body.pose, 1);
      REQUIRE(apart.count > 0);
      body.pose.position.y() -= apart.points[0].distance;
      body.velocity = 2 * Vec3(std::cos(angle), 0, std::sin(angle));
      world.add(body);
      const double height = body.pose.position.y();
      for (int n = 0; n < 45; ++n) {
        world.step();
        hop = std::max(hop, std::abs(world.pose(1).position.y() - height));
        loss = std::max(loss, std::abs(1 - world.velocity(1).norm() / 2));
        spin = std::max(spin, world.angular_velocity(1).norm());
      }
    }
    MESSAGE(named.name << ": hop " << 1000 * hop << " mm, speed loss " << 100 * loss << " %, spin " << spin
                       << " rad/s; ground at " << 1000 * ground << " mm");
    CHECK(hop <= 0.05e-3);
    CHECK(loss <= 1e-4);
    CHECK(spin <= 0.01);
  }
}
