// When within a step of 2 ms did it touch? Asked of a world with steps 16 times as short, started anew before
// every blow from what the world with long steps had reached.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <string>

#include "intaglio/dynamics/world.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using dynamics::World;
using dynamics::WorldOptions;

namespace {

constexpr double step = 1.0 / 480, radius = 0.02, side = 0.5;
constexpr int finer = 16;

struct State {
  Pose pose;
  Vec3 velocity, angular_velocity;
  bool flies;  // in the step that follows
};
State state_of(const World& world) {
  return {world.pose(1), world.velocity(1), world.angular_velocity(1), false};
}

struct Run {
  std::shared_ptr<const surface::Surface> surface;
  Material floor;
  dynamics::SphereBody ball;

  World world(double dt) const {
    WorldOptions options;
    options.step = dt;
    World made(surface, floor, options);
    made.add(ball);
    return made;
  }

  // Of a blow of `impulse` (N s) at about `guess` s after `before`: when the fine world has one of at least a
  // third of it, the nearest. Its impulse is what comes within half a millisecond beyond what was there
  // before.
  double distance_to_blow(const State& before, double impulse, double guess) const {
    World fine = world(step / finer);
    // Flying, the world with long steps is where the parabola is that is faster by half a step's fall.
    const Vec3 fall = before.flies ? Vec3(0, -9.81 * step / 2, 0) : Vec3::Zero();
    fine.put(1, before.pose, before.velocity + fall, before.angular_velocity);
    std::vector<double> each;
    for (int k = 0; k < 4 * finer; ++k) {
      fine.step();
      double sum = 0;
      for (const ContactEvent& event : fine.events()) sum += event.impulse.norm();
      each.push_back(sum);
    }
    double best = 1;
    for (std::size_t k = 0; k + 4 < each.size(); ++k) {
      const double last = k == 0 ? 0 : each[k - 1];
      double blow = 0;
      for (std::size_t i = k; i < k + 4; ++i) blow += std::max(0.0, each[i] - last);
      const bool begins = each[k] > 2 * last && each[k] > 0.25 * blow;
      if (begins && blow > impulse / 3)
        best = std::min(best, std::abs((double(k) + 0.5) * step / finer - guess));
    }
    if (best > 0.9e-3) {
      printf("off %.2f guess %.3f imp %.2e:", 1e3 * best, 1e3 * guess, impulse);
      for (std::size_t k = 0; k < each.size(); ++k)
        if (each[k] > 1e-7) printf(" %.2f:%.1e", (k + .5) * 1e3 * step / finer, each[k]);
      puts("");
    }
    return best;
  }

  // All blows of a run, s from the fine world's.
  std::vector<double> errors(double seconds, double least_speed) const {
    World coarse = world(step);
    std::deque<State> past{state_of(coarse)};
    std::vector<double> out;
    double last = 0;
    for (int k = 1; k < seconds / step; ++k) {
      coarse.step();
      double whole = 0;
      for (const ContactEvent& event : coarse.events()) whole += event.impulse.norm();
      // The first of those that matter.
      const ContactEvent* blow = nullptr;
      for (const ContactEvent& event : coarse.events()) {
        if (!std::isnan(event.touch_age) && event.impulse.norm() > whole / 3 &&
            (!blow || event.touch_age > blow->touch_age))
          blow = &event;
      }
      if (blow) {
        CHECK(blow->touch_age >= 0);
        CHECK(blow->touch_age <= blow->duration);
        CHECK(blow->time <= coarse.time() + 1e-9);
      }
      if (blow && blow->impulse.norm() > ball.mass() * least_speed + last) {
        const double guess = blow->time - blow->touch_age - (k - double(past.size())) * step;
        if (getenv("V"))
          for (const ContactEvent& event : coarse.events())
            printf(" ev %d age %.3f imp %.2e n %.2f %.2f v %.3f %.3f\n", k, 1e3 * event.touch_age,
                   event.impulse.norm(), event.impulse.x() / event.impulse.norm(),
                   event.impulse.y() / event.impulse.norm(), past.back().velocity.x(),
                   past.back().velocity.y());
        out.push_back(distance_to_blow(past.front(), blow->impulse.norm(), guess));
      }
      last = whole;
      past.back().flies = coarse.events().empty();
      past.push_back(state_of(coarse));
      if (past.size() > 2) past.pop_front();
    }
    std::sort(out.begin(), out.end());
    return out;
  }
};

std::shared_ptr<const surface::Surface> grating(double wavelength, double depth) {
  const auto wave = [=](Vec2 uv) { return std::fmod(uv.x() * side / wavelength, 1.0) < 0.5 ? 0.0 : 1.0; };
  return tests::made_surface(
      1000, wave, [](Vec2) { return Vec3(0, 0, 1); }, depth, tests::flat_placement(side));
}

Material without_rolling(double restitution) {
  Material material = *find_material("steel");
  material.rolling_resistance = 0;
  material.restitution = restitution;
  return material;
}

void tell(const std::string& what, const std::vector<double>& errors) {
  REQUIRE(errors.size() > 5);
  MESSAGE(what << ": " << errors.size() << " blows, from the fine world's median "
               << 1e3 * errors[errors.size() / 2] << " ms, 95 % within "
               << 1e3 * errors[errors.size() * 95 / 100] << " ms, worst " << 1e3 * errors.back() << " ms");
}

}  // namespace

TEST_CASE("blows of a ball that rolls over a grating are timed within a millisecond at 480 Hz") {
  for (const double restitution : {0.0, 0.7}) {
    CAPTURE(restitution);
    Run run{grating(0.02, 0.0002), without_rolling(restitution), {radius, without_rolling(restitution)}};
    run.ball.position = {-0.2, radius + 1e-4, 0.01};
    run.ball.velocity = {0.3, 0, 0};
    run.ball.angular_velocity = {0, 0, -0.3 / radius};
    const std::vector<double> errors = run.errors(1.2, 0.02);
    tell("rolling", errors);
    if (restitution == 0) CHECK(errors.back() < 1e-3);
    // A hop of a few steps is not the fine world's: its beginning and its end are both within a step.
    CHECK(errors[errors.size() * 9 / 10] < 1e-3);
    CHECK(errors.back() < step);
  }
}

TEST_CASE("blows of a ball that bounces are timed within a millisecond at 480 Hz") {
  Run run{tests::brick_surface(128, side), without_rolling(0.7), {radius, without_rolling(0.9)}};
  std::vector<double> errors;
  for (int k = 0; k < 12; ++k) {
    run.ball.position = {0.03 * k - 0.2, 0.07 + 0.003 * k, 0.017 * k};
    run.ball.velocity = {0.1, 0, 0.05};
    for (const double e : run.errors(0.5, 0.1)) errors.push_back(e);
  }
  std::sort(errors.begin(), errors.end());
  tell("bouncing", errors);
  CHECK(errors.back() < 1e-3);
}
