// Two bounces in one step that face each other, and driven bodies in worlds that take substeps: neither
// adds energy.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "dynamics/world.h"
#include "intaglio/representation.h"
#include "tests/mesh/curved_bases.h"

using namespace intaglio;
using namespace intaglio::dynamics;
using std::numbers::pi;

namespace {

Material slippery(double restitution) {
  Material out;
  out.density = 2000;
  out.friction = out.rolling_resistance = 0;
  out.restitution = restitution;
  return out;
}

std::shared_ptr<const surface::Surface> plane(const Vec3& centre) {
  return tests::made_surface(
      8, [](Vec2) { return 0.0; }, [](Vec2) { return Vec3::UnitZ(); }, 0, {centre, Quat::Identity(), 4, 4});
}

}  // namespace

TEST_CASE("a ball thrown into a groove narrower than a right angle comes out no faster") {
  constexpr double side = 0.4, radius = 0.03, speed = 3;
  double worst = 0;
  int blows = 0;
  for (const double half_angle : {20.0, 30.0, 35.0}) {
    const double slope = half_angle * pi / 180, deep = 0.1 / std::tan(slope);
    const auto groove = tests::made_surface(
        64, [](Vec2 uv) { return std::max(0.0, 1 - 4 * std::abs(uv.x() - 0.5)); },
        [](Vec2) { return Vec3::UnitZ(); }, deep, {{0, 0.5, 0}, Quat::Identity(), side, side});
    for (const double restitution : {0.5, 0.9}) {
      for (int k = 0; k < 40; ++k) {
        World world(plane({0, -3, 0}), slippery(1), {});
        ShapeBody block;
        block.shape = contact::Box{{side / 2, 0.5, side / 2}};
        block.material = slippery(1);
        block.motion = Motion::fixed;
        block.pose.position = {0, -0.5, 0};
        block.faces = {groove};
        world.add(block);
        const double tilt = (k - 19.5) * 0.9 / 20 * slope;
        const Vec3 way(std::sin(tilt), -std::cos(tilt), 0), seat(0, radius / std::sin(slope) - deep, 0);
        SphereBody ball{radius, slippery(restitution), seat - (0.02 + 0.0007 * (k % 11)) * way, speed * way};
        const BodyId id = world.add(ball);
        const auto energy = [&] {
          return 0.5 * world.velocity(id).squaredNorm() + 9.81 * world.pose(id).position.y();
        };
        for (int n = 0; n < 40; ++n) {
          const double before = energy();
          const Vec3 velocity = world.velocity(id);
          world.step();
          worst = std::max(worst, (energy() - before) / (0.5 * speed * speed));
          blows += (world.velocity(id) - velocity).norm() > 0.3;
        }
      }
    }
  }
  MESSAGE(blows << " blows, the most that one gained " << 100 * worst << " % of the ball's energy");
  CHECK(blows > 200);
  CHECK(worst < 0.02);
}

TEST_CASE("a paddle throws a ball as fast whether or not the world takes substeps for another") {
  double first = 0;
  for (const double other : {0.0, 2.0, 6.0, 12.0}) {
    WorldOptions options;
    options.representation = Representation::flat;
    options.gravity.setZero();
    World world(plane(Vec3::Zero()), slippery(1), options);
    ShapeBody paddle;
    paddle.shape = contact::Box{{0.02, 0.05, 0.1}};
    paddle.material = slippery(0.5);
    paddle.motion = Motion::driven;
    paddle.pose.position = {-0.2, 0.3, 0};
    const BodyId driven = world.add(paddle);
    const BodyId thrown = world.add(SphereBody{0.05, slippery(0.5), {0, 0.3, 0}});
    world.add(SphereBody{0.02, slippery(0.5), {0, 1, 1.5}, {0, other, 0}});
    double fastest = 0;
    for (int k = 0; k < 240; ++k) {
      const Vec3 goal(std::min(-0.2 + k / 480.0, 0.0), 0.3, 0);
      world.drive(driven, {goal, Quat::Identity()});
      world.step();
      CHECK((world.pose(driven).position - goal).norm() < 1e-6);
      fastest = std::max(fastest, world.velocity(thrown).x());
    }
    if (other == 0) first = fastest;
    CHECK(first > 1);
    CHECK(fastest == doctest::Approx(first).epsilon(0.05));
  }
}
