// Reliefs on curved bases in Bullet: a ball in a bowl, on a pipe, and a textured ball on the floor.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "dynamics/textured_shape.h"
#include "tests/dynamics/curved_world.h"

using namespace intaglio;
using tests::CurvedWorld;
using tests::energy;
using tests::g;
using tests::vec;

TEST_CASE("a ball rolls to and fro in a smooth bowl at the frequency of the closed form" *
          doctest::test_suite("statistics")) {
  const double R = 1, r = 0.1, amplitude = 0.1;
  dynamics::CurvedShape bowl(tests::relief_on(surface::make_bowl(R, 512, 256), tests::no_relief()));
  CurvedWorld plain;
  plain.add_rolling(0, bowl, Vec3::Zero());
  btSphereShape ball{btScalar(r)};
  // Along a diagonal that the mesh does not favour.
  const double heading = 0.3, rate = 480;
  const Vec3 out(std::cos(heading), 0, std::sin(heading));
  btRigidBody& body = plain.add_rolling(
      1, ball, (R - r - 3e-5) * (std::sin(amplitude) * out - std::cos(amplitude) * Vec3::UnitY()));
  const double first = energy(body);
  double highest = first, last = 1, last_time = 0, aside = 0;
  std::vector<double> crossings;
  for (int k = 1; crossings.size() < 9 && k < 20 * rate; ++k) {
    plain.world.stepSimulation(btScalar(1 / rate), 0);
    const Vec3 at = vec(body.getWorldTransform().getOrigin());
    const double x = at.dot(out), time = k / rate;
    if ((x < 0) != (last < 0)) crossings.push_back(last_time + (time - last_time) * last / (last - x));
    last = x;
    last_time = time;
    aside = std::max(aside, std::abs(at.dot(Vec3(-out.z(), 0, out.x()))));
    highest = std::max(highest, energy(body));
  }
  REQUIRE(crossings.size() == 9);
  const double frequency = 4 / (crossings.back() - crossings.front());
  const double closed = std::sqrt(5.0 / 7 * g / (R - r)) / (2 * std::numbers::pi);
  // The amplitude is not small: the period is longer by a factor of 1 + a^2 / 16.
  MESSAGE("frequency " << frequency << " Hz, closed form " << closed << ", off by "
                       << 100 * (frequency / closed - 1) << " %; energy " << first << " -> " << energy(body)
                       << " J/kg, highest " << highest - first << " over it, aside " << aside);
  CHECK(std::abs(frequency / closed - 1) < 0.01);
  CHECK(highest - first < 1e-4 * g * r);
  CHECK(aside < 0.01 * R);
}

TEST_CASE(
    "a ball in a relief-mapped bowl: energy never rises, and it comes to rest in a dimple or at the bottom") {
  const double R = 0.5, r = 0.03;
  // Dimples, 8 around and 8 up, 5 mm deep, but none at the bottom, where the map's sides meet.
  const double depth = 0.005;
  const auto dimples = tests::made_surface(
      256,
      [](Vec2 uv) {
        const double up = std::sin(8 * std::numbers::pi * uv.y()),
                     around = std::sin(8 * std::numbers::pi * uv.x());
        return std::min(1.0, 20 * uv.y()) * up * up * around * around;
      },
      [](Vec2) { return Vec3::UnitZ(); }, depth);
  dynamics::CurvedShape bowl(tests::relief_on(surface::make_bowl(R, 128, 64), dimples));
  for (const int rate : {120, 480}) {
    if (tests::is_sampled() && rate > 120) continue;
    CurvedWorld plain;
    plain.add_rolling(0, bowl, Vec3::Zero());
    btSphereShape ball{btScalar(r)};
    btRigidBody& body = plain.add_rolling(1, ball, Vec3(0.2, -0.38, 0.05));
    body.setRollingFriction(btScalar(0.001));
    const double first = energy(body);
    double highest = first, lowest_so_far = first, rise = 0;
    for (int k = 1; k < 15 * rate; ++k) {
      plain.world.stepSimulation(btScalar(1.0 / rate), 0);
      const double now = energy(body);
      highest = std::max(highest, now);
      rise = std::max(rise, now - lowest_so_far);
      lowest_so_far = std::min(lowest_so_far, now);
    }
    const Vec3 at = vec(body.getWorldTransform().getOrigin());
    const auto under = bowl.relief().base().closest(at, 1);
    REQUIRE(under);
    MESSAGE(rate << " Hz: energy " << first << " -> " << energy(body) << " J/kg, highest over the first "
                 << highest - first << ", greatest rise " << rise << "; at rest at " << at.transpose()
                 << ", depth " << dimples->depth(under->uv) << ", speed "
                 << vec(body.getLinearVelocity()).norm());
    CHECK(vec(body.getLinearVelocity()).norm() < 1e-3);
    // In a dimple, or at the bottom itself, which has none: rounding decides which.
    const bool at_bottom = 20 * under->uv.y() < 1;
    CHECK((at_bottom || dimples->depth(under->uv) > 0.5 * depth));
    CHECK(highest - first < 1e-4 * g * r);
    CHECK(rise < 1e-3 * g * r);
    CHECK(at.norm() < R);
  }
}

TEST_CASE("a ball rolls along a smooth pipe and off a textured one; both orders of the pair agree") {
  const double R = 0.5, r = 0.1;
  // The pipe's axis along X.
  const auto lying = [&](std::shared_ptr<const surface::Surface> s) {
    const Pose turn{Vec3::Zero(), Quat(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitZ()))};
    return tests::relief_on(surface::moved(surface::make_cylinder(R, 4, 512, 4), turn), std::move(s));
  };
  const auto bricks = tests::brick_surface(256);
  for (const bool textured : {false, true}) {
    dynamics::CurvedShape pipe(lying(textured ? bricks : tests::no_relief()));
    std::array<Vec3, 2> ends;
    for (const bool ball_first : {true, false}) {
      CurvedWorld plain;
      btSphereShape ball{btScalar(r)};
      btRigidBody* body = nullptr;
      const auto add_ball = [&] {
        body = &plain.add_rolling(1, ball, Vec3(-1.5, R + r + (textured ? 0.001 : 1e-5), 0));
        body->setLinearVelocity({1, 0, 0});
        body->setAngularVelocity({0, 0, btScalar(-1 / r)});
      };
      if (ball_first) add_ball();
      plain.add_rolling(0, pipe, Vec3::Zero());
      if (!ball_first) add_ball();
      const double first = energy(*body);
      double highest = first;
      for (int k = 0; k < 480; ++k) {
        plain.world.stepSimulation(btScalar(1.0 / 480), 0);
        highest = std::max(highest, energy(*body));
        CHECK(std::hypot(vec(body->getWorldTransform().getOrigin()).y(),
                         vec(body->getWorldTransform().getOrigin()).z()) > R + r - 0.022);
      }
      ends[ball_first ? 0 : 1] = vec(body->getWorldTransform().getOrigin());
      CHECK(highest - first < 1e-4 * g * r);
    }
    MESSAGE(std::string(textured ? "bricks: " : "smooth: ")
            << "after a second at " << ends[0].transpose() << " and " << ends[1].transpose());
    CHECK((ends[0] - ends[1]).norm() < 1e-3);
    if (!textured) CHECK(ends[0].x() == doctest::Approx(-0.5).epsilon(0.02));
  }
}

TEST_CASE("a brick ball rests and rolls on a brick floor, the floor added first or last" *
          doctest::test_suite("statistics")) {
  const double R = 0.2;
  const auto bricks = tests::brick_surface(256);  // 2 cm deep on 1 m
  surface::TriangleMesh mesh = tests::tiled(surface::make_sphere(R, 96, 48), {2, 1});
  // Its own bricks are shallower.
  const auto own = tests::made_surface(
      128, [&](Vec2 uv) { return bricks->depth(uv) / bricks->max_depth(); },
      [](Vec2) { return Vec3::UnitZ(); }, 0.005);
  for (const bool floor_first : {true, false}) {
    CurvedWorld plain(bricks);
    dynamics::CurvedShape ball(tests::relief_on(mesh, own));
    if (floor_first) plain.add_rolling(0, plain.shape, Vec3::Zero());
    btRigidBody& body = plain.add_rolling(2, ball, Vec3(-0.2, R + 0.01, 0.05));
    body.setRollingFriction(btScalar(0.004));
    if (!floor_first) plain.add_rolling(0, plain.shape, Vec3::Zero());
    body.setLinearVelocity({btScalar(0.3), 0, 0});
    const double first = energy(body);
    double highest = first;
    for (int k = 0; k < 5 * 240; ++k) {
      plain.world.stepSimulation(btScalar(1.0 / 240), 0);
      highest = std::max(highest, energy(body));
    }
    const Vec3 at = vec(body.getWorldTransform().getOrigin());
    MESSAGE(std::string(floor_first ? "floor first: " : "floor last: ")
            << "at " << at.transpose() << ", speed " << vec(body.getLinearVelocity()).norm()
            << ", highest energy " << highest - first);
    CHECK(at.y() > R - 0.026);
    CHECK(at.y() < R + 0.001);
    CHECK(highest - first < 1e-3 * g * R);
    CHECK(vec(body.getLinearVelocity()).norm() < 0.02);
  }
}
