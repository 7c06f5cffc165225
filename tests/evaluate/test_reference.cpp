#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "evaluate/reference.h"
#include "evaluate/reference_motion.h"
#include "evaluate/subject.h"
#include "surface/recipes/builtin.h"
#include "surface/surface.h"

namespace intaglio::evaluate {

namespace {

// A relief of which everything is known: z = -a (1 - cos(2 pi x / wave)) / 2 along x, on a metre.
surface::Surface waves(double amplitude, int count, int size = 512) {
  surface::Texels texels;
  texels.width = texels.height = size;
  for (int j = 0; j < size; ++j) {
    for (int i = 0; i < size; ++i) {
      const double phase = 2 * std::numbers::pi * count * (i + 0.5) / size;
      texels.depth.push_back(float(0.5 * (1 - std::cos(phase))));
      const double slope = -amplitude * std::numbers::pi * count * std::sin(phase);
      texels.normal.push_back(Vec3(-slope, 0, 1).normalized());
    }
  }
  texels.colour = Image8(1, 1, 3);
  return {std::move(texels), {Vec3::Zero(), Quat::Identity(), 1, 1}, amplitude, surface::Edge::wrap};
}

}  // namespace

TEST_CASE("The reference of a recipe is the surface that is made of it, where texels resolve it") {
  const surface::Recipe recipe = surface::find_builtin("brick").value();
  const surface::Surface surface(surface::to_texels(surface::make_texture(recipe, 512)),
                                 {Vec3::Zero(), Quat::Identity(), 1, 1}, 0.02, surface::Edge::wrap);
  const Reference reference(recipe, {1, 1}, 0.02, 512);
  double squares = 0, all = 0;
  int count = 0;
  for (double x = 0.003; x < 1; x += 0.0131) {
    for (double y = 0.004; y < 1; y += 0.0137) {
      const double truth = reference.height({x, y});
      squares += std::pow(truth - surface.smooth({x, y}).height, 2);
      all += std::pow(truth - reference.mean(), 2);
      ++count;
    }
  }
  CHECK(std::sqrt(squares / count) < 2e-4);
  CHECK(squares < 1e-3 * all);
}

TEST_CASE("A reference ball rests where the closed form says, on plane, crest and trough") {
  const double amplitude = 0.02;
  const Reference reference(waves(amplitude, 2), 1024);
  // Curvature of the crest and of the trough: a (2 pi n)^2 / 2.
  const double radius_of_relief = 1 / (0.5 * amplitude * std::pow(2 * std::numbers::pi * 2, 2));
  for (const double radius : {0.001, 0.01, 0.04}) {
    CAPTURE(radius);
    REQUIRE(radius < radius_of_relief);
    const RestingBall crest = reference.rest_on({0.5, 0.3}, radius);
    CHECK(std::abs(crest.z) < 2e-6);
    CHECK(crest.slope.norm() < 1e-3);
    const RestingBall trough = reference.rest_on({0.25, 0.3}, radius);
    CHECK(std::abs(trough.z + amplitude) < 2e-6);
    // On a slope the touched point is at right angles below the centre.
    const Vec2 p(0.31, 0.62);
    const RestingBall side = reference.rest_on(p, radius);
    const Vec3 centre(p.x(), p.y(), side.z + radius);
    const Vec3 normal = Vec3(-side.slope.x(), -side.slope.y(), 1).normalized();
    CHECK((centre - radius * normal - side.touch).norm() < 2e-3 * radius + 2e-6);
  }
}

TEST_CASE("No point of the relief is inside a ball that rests on the reference") {
  const Reference reference(surface::find_builtin("pebbles").value(), {1, 1}, 0.03, 512);
  for (int k = 0; k < 40; ++k) {
    const Vec2 p(0.1 + 0.8 * std::fmod(k * 0.618034, 1), 0.1 + 0.8 * std::fmod(k * 0.754878, 1));
    for (const double radius : {0.003, 0.04}) {
      const RestingBall ball = reference.rest_on(p, radius);
      const Vec3 centre(p.x(), p.y(), ball.z + radius);
      double least = 1;
      for (double x = -radius; x <= radius; x += 0.05 * radius)
        for (double y = -radius; y <= radius; y += 0.05 * radius) {
          const Vec2 q = p + Vec2(x, y);
          least = std::min(least, (Vec3(q.x(), q.y(), reference.height(q)) - centre).norm());
        }
      CHECK(least > 0.985 * radius);
      CHECK(least < 1.02 * radius);
    }
  }
}

TEST_CASE("A reference ball obeys free fall, rolling and friction in closed form") {
  const Reference flat(waves(0, 1, 64), 256);
  const Material plastic = *find_material("plastic"), brick = *find_material("brick");
  const double radius = 0.03;
  SUBCASE("it falls freely and bounces to the height of its restitution") {
    ReferenceBall ball(flat, radius, plastic, brick);
    ball.put({{{0.5, 0.5, radius + 0.1}, Quat::Identity()}, Vec3::Zero(), Vec3::Zero()});
    double highest = 0;
    bool touched = false;
    for (int k = 0; k < int(0.4 * reference_rate); ++k) {
      ball.step();
      touched = touched || ball.touches();
      if (touched) highest = std::max(highest, ball.state().pose.position.z() - radius);
    }
    const double e = plastic.restitution * brick.restitution;
    CHECK(highest == doctest::Approx(0.1 * e * e).epsilon(0.002));
  }
  SUBCASE("it slides until it rolls at five sevenths of its speed") {
    Material smooth = plastic;
    smooth.rolling_resistance = 0;
    Material floor = brick;
    floor.rolling_resistance = 0;
    ReferenceBall ball(flat, radius, smooth, floor);
    ball.put({{{0.2, 0.5, radius}, Quat::Identity()}, {0.4, 0, 0}, Vec3::Zero()});
    for (int k = 0; k < int(0.5 * reference_rate); ++k) ball.step();
    CHECK(ball.state().velocity.x() == doctest::Approx(0.4 * 5 / 7).epsilon(0.005));
    CHECK(ball.state().angular_velocity.y() == doctest::Approx(0.4 * 5 / 7 / radius).epsilon(0.005));
  }
  SUBCASE("it gains no energy on a relief") {
    const Reference relief(surface::find_builtin("brick").value(), {1, 1}, 0.02, 512);
    ReferenceBall ball(relief, radius, plastic, brick);
    const double z = relief.rest_on({0.3, 0.3}, radius).z;
    ball.put(
        {{{0.3, 0.3, z + radius + 1e-4}, Quat::Identity()}, {0.3, 0.2, 0}, {-0.2 / 0.03, 0.3 / 0.03, 0}});
    double before = ball.energy();
    const double first = before;
    for (int k = 0; k < int(0.5 * reference_rate); ++k) {
      ball.step();
      CHECK(ball.energy() < before + 1e-4 * std::abs(first));
      before = ball.energy();
    }
    CHECK(ball.energy() < first);
  }
}

TEST_CASE("The reference pen pushes along the normal without friction, and sticks within its cone") {
  const Reference flat(waves(0, 1, 64), 256);
  ReferencePen slippery(flat, 0.001, 1000, 0);
  slippery.follow({0.5, 0.5, -0.001});
  const Vec3 force = slippery.follow({0.51, 0.5, -0.001});
  CHECK(std::abs(force.z() - 1) < 1e-6);
  CHECK(force.head<2>().norm() < 1e-3);
  ReferencePen rough(flat, 0.001, 1000, 0.5);
  rough.follow({0.5, 0.5, -0.001});
  const Vec3 held = rough.follow({0.5003, 0.5, -0.001});
  CHECK(held.x() == doctest::Approx(-0.3).epsilon(1e-3));
  const Vec3 slid = rough.follow({0.51, 0.5, -0.001});
  CHECK(slid.x() == doctest::Approx(-0.5).epsilon(0.01));
}

}  // namespace intaglio::evaluate
