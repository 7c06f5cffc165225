// Two textured bodies, which none of the paper's other methods can handle.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "intaglio/representation.h"
#include "tests/dynamics/plain_bullet.h"
#include "tests/dynamics/worlds.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using tests::grating_depth;
using tests::grating_period;
using tests::PlainBullet;

namespace {

constexpr double slope_angle = 20 * std::numbers::pi / 180;

// Ridges across X, on a square of `side` metres; the block's face down, 5 cm under its middle.
std::shared_ptr<const surface::Surface> grating_with_normals(double side,
                                                             const surface::Placement& placement) {
  const auto phase = [=](Vec2 uv) {
    return 2 * std::numbers::pi * (uv.x() * side - 0.5 * side) / grating_period;
  };
  const double steepest = grating_depth * std::numbers::pi / grating_period;
  return tests::made_surface(
      int(std::lround(side / 0.01)), [=](Vec2 uv) { return 0.5 + 0.5 * std::cos(phase(uv)); },
      [=](Vec2 uv) { return Vec3(-steepest * std::sin(phase(uv)), 0, 1); }, grating_depth, placement);
}

// How far a block slides in a second on a slope that falls towards +X.
double slides(PlainBullet& plain, btCollisionShape& block, double height) {
  plain.world.setGravity(
      {btScalar(9.81 * std::sin(slope_angle)), btScalar(-9.81 * std::cos(slope_angle)), 0});
  btRigidBody& ground = plain.add(0, plain.shape, {0, 0, 0});
  ground.setFriction(btScalar(0.45));
  btRigidBody& body = plain.add(2, block, {btScalar(-0.4), btScalar(height), 0});
  body.setFriction(btScalar(0.45));
  plain.run(1, 240);
  CHECK(double(body.getWorldTransform().getOrigin().y()) > -0.02);
  return double(body.getWorldTransform().getOrigin().x()) + 0.4;
}

}  // namespace

TEST_CASE("gratings of one period interlock: they hold a slope that a flat pair slides down") {
  const auto below = grating_with_normals(2.4, tests::flat_placement(2.4));
  const Quat upside_down(Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitX()));
  const auto above = grating_with_normals(0.32, {Vec3(0, -0.05, 0), upside_down, 0.32, 0.32});
  PlainBullet rough(below);
  dynamics::TexturedShape block(above);
  const double held = slides(rough, block, 0.06);

  PlainBullet flat(below, {Representation::flat, dynamics::ContactMethod::closest, {}});
  btBoxShape plain_block({btScalar(0.16), btScalar(0.05), btScalar(0.16)});
  const double slid = slides(flat, plain_block, 0.052);
  const double friction = 0.45 * 0.45;
  const double expected = 0.5 * 9.81 * (std::sin(slope_angle) - friction * std::cos(slope_angle));
  MESSAGE("in a second the gratings moved " << 1000 * held << " mm, the flat pair " << 1000 * slid
                                            << " mm; friction alone gives " << 1000 * expected);
  CHECK(std::abs(held) < grating_period);
  CHECK(slid > 0.5);
}
