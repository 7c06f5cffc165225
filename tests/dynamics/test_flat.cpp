#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/dynamics/brick_scene.h"

using namespace intaglio;
using namespace intaglio::dynamics;
namespace scene = intaglio::tests::brick_scene;

namespace {

// A relief whose texels are all as deep: flat, but searched cell by cell.
std::shared_ptr<const surface::Surface> even_relief() {
  return tests::made_surface(
      512, [](Vec2) { return 0.5; }, [](Vec2) { return Vec3::UnitZ(); }, 0.02 * scene::side,
      tests::flat_placement(scene::side));
}

}  // namespace

TEST_CASE("T2: without friction a body slides over flat relief in any direction as over glass") {
  const auto s = even_relief();
  const double ground = -0.01 * scene::side;
  const int directions = tests::poses(16, 64);
  double hop = 0, loss = 0, spin = 0;
  for (int k = 0; k < directions; ++k) {
    const double angle = 2 * std::numbers::pi * k / directions;
    World world(s, scene::material(0), scene::options(60));
    SphereBody ball;
    ball.radius = scene::radius;
    ball.material = scene::material(0);
    ball.position = {0.013, ground + scene::radius, -0.021};
    ball.velocity = 2 * Vec3(std::cos(angle), 0, std::sin(angle));
    world.add(ball);
    for (int n = 0; n < 45; ++n) {
      world.step();
      hop = std::max(hop, std::abs(world.pose(1).position.y() - ground - scene::radius));
      loss = std::max(loss, std::abs(1 - world.velocity(1).norm() / 2));
      spin = std::max(spin, world.angular_velocity(1).norm());
    }
  }
  MESSAGE("sphere: hop " << 1000 * hop << " mm, speed loss " << 100 * loss << " %, spin " << spin
                         << " rad/s");
  CHECK(hop <= 0.05e-3);
  CHECK(loss <= 1e-4);
  CHECK(spin <= 0.01);
}
