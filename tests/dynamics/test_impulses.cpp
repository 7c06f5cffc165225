#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "intaglio/representation.h"
#include "tests/dynamics/brick_scene.h"

using namespace intaglio;
using namespace intaglio::dynamics;
namespace scene = intaglio::tests::brick_scene;

TEST_CASE("T11: reported impulses are m dv - m g dt for every ball, none missing or doubled at cell borders" *
          doctest::test_suite("statistics")) {
  const auto s = scene::floor(tests::quick_or_slow(256, 512));
  auto balls = scene::balls(*s, tests::poses(25, 100));
  // Half of them bounce.
  for (std::size_t k = 0; k < balls.size(); k += 2) balls[k].material.restitution = 0.7;
  Material ground = scene::material();
  ground.restitution = 0.8;
  for (const auto representation : {Representation::flat, Representation::normal, Representation::relief}) {
    WorldOptions options = scene::options(240);
    options.representation = representation;
    World world(s, ground, options);
    for (const SphereBody& ball : balls) world.add(ball);
    std::vector<Vec3> reported(balls.size(), Vec3::Zero()), before(balls.size());
    std::vector<double> exchanged(balls.size(), 0.0), worst(balls.size(), 0.0);
    for (std::size_t k = 0; k < balls.size(); ++k) before[k] = world.velocity(BodyId(k + 1));
    constexpr int steps = 480, window = 24;
    double error = 0;
    for (int n = 1; n <= steps; ++n) {
      world.step();
      for (const ContactEvent& e : world.events()) {
        reported[e.body - 1] += e.impulse;
        exchanged[e.body - 1] += e.impulse.norm();
      }
      if (n % window != 0) continue;
      // A tenth of a second at a time: impulses against the change of momentum.
      for (std::size_t k = 0; k < balls.size(); ++k) {
        const auto id = BodyId(k + 1);
        const double m = balls[k].mass(), time = window / 240.0;
        const Vec3 velocity = world.velocity(id);
        const Vec3 wanted = m * (velocity - before[k]) - m * Vec3(0, -scene::gravity, 0) * time;
        // A ball that fell asleep is held without contacts.
        if (exchanged[k] > 0 && velocity.norm() > 0)
          error = std::max(error,
                           (reported[k] - wanted).norm() / std::max(exchanged[k], m * scene::gravity * time));
        before[k] = velocity;
        reported[k].setZero();
        exchanged[k] = 0;
      }
    }
    MESSAGE("worst disagreement: " << 100 * error << " %; in a step: " << world.momentum_residual()
                                   << " N s");
    CHECK(error < 0.01);
  }
}
