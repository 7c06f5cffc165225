// The time of a touch within a step of 2 ms, compared with a world whose steps are 16 times shorter,
// restarted before every impact from the state of the coarse world.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <string>

#include "dynamics/world.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using dynamics::World;
using dynamics::WorldOptions;

namespace {

constexpr double coarse_step = 1.0 / 480, ball_radius = 0.02, floor_side = 0.5;
constexpr int finer = 16;

struct State {
  Pose pose;
  Vec3 velocity, angular_velocity;
  bool flies;  // in the step that follows
};
State state_of(const World& world) {
  return {world.pose(1), world.velocity(1), world.angular_velocity(1), false};
}

struct TimedRun {
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

  // For an impact of `impulse` (N s) at about `guess` s after `before`: the time of the nearest impact in the
  // fine world of at least a quarter of it (near the threshold, one of the two may bounce and the other not).
  // Its impulse is the sum over half a millisecond, less the resting contact before.
  double distance_to_blow(const State& before, double impulse, double guess) const {
    World fine = world(coarse_step / finer);
    // In flight, the coarse world follows the parabola that is faster by half a step of gravity.
    const Vec3 fall = before.flies ? Vec3(0, -9.81 * coarse_step / 2, 0) : Vec3::Zero();
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
      if (begins && blow > impulse / 4)
        best = std::min(best, std::abs((double(k) + 0.5) * coarse_step / finer - guess));
    }
    return best;
  }

  // The timing errors of all impacts of a run, s.
  std::vector<double> errors(double seconds, double least_speed) const {
    World coarse = world(coarse_step);
    std::deque<State> past{state_of(coarse)};
    std::vector<double> out;
    double last = 0;
    for (int k = 1; k < seconds / coarse_step; ++k) {
      coarse.step();
      double whole = 0;
      for (const ContactEvent& event : coarse.events()) whole += event.impulse.norm();
      // The first point with a significant impulse.
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
        const double guess = blow->time - blow->touch_age - (k - double(past.size())) * coarse_step;
        out.push_back(distance_to_blow(past.front(), blow->impulse.norm(), guess));
      }
      last = whole;
      // A grazing contact does not support it.
      past.back().flies = whole < 0.5 * ball.mass() * 9.81 * coarse_step;
      past.push_back(state_of(coarse));
      if (past.size() > 2) past.pop_front();
    }
    std::sort(out.begin(), out.end());
    return out;
  }
};

std::shared_ptr<const surface::Surface> square_grooves(double wavelength, double depth) {
  const auto wave = [=](Vec2 uv) {
    return std::fmod(uv.x() * floor_side / wavelength, 1.0) < 0.5 ? 0.0 : 1.0;
  };
  return tests::made_surface(
      1000, wave, [](Vec2) { return Vec3(0, 0, 1); }, depth, tests::flat_placement(floor_side));
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

TEST_CASE("impacts of a ball that rolls over a grating are timed within a millisecond at 480 Hz" *
          doctest::test_suite("statistics")) {
  for (const auto& grooves : {std::pair{0.02, 0.0002}, {0.01, 0.0001}, {0.03, 0.001}}) {
    const double wavelength = grooves.first;
    const auto surface = square_grooves(wavelength, grooves.second);
    for (const double restitution : {0.0, 0.5, 0.7, 0.8, 0.95}) {
      CAPTURE(wavelength);
      CAPTURE(restitution);
      TimedRun run{surface, without_rolling(restitution), {ball_radius, without_rolling(restitution)}};
      std::vector<double> errors;
      for (const double speed : {0.15, 0.3, 0.5}) {
        run.ball.position = {-0.2, ball_radius + 1e-4, 0.01};
        run.ball.velocity = {speed, 0, 0};
        run.ball.angular_velocity = {0, 0, -speed / ball_radius};
        for (const double e : run.errors(0.4 / speed, 0.02)) errors.push_back(e);
      }
      std::sort(errors.begin(), errors.end());
      tell("rolling", errors);
      CHECK(errors.back() < 1e-3);
      CHECK(errors[errors.size() * 95 / 100] < 0.7e-3);
    }
  }
}

TEST_CASE("impacts of a bouncing ball are timed within a millisecond at 480 Hz") {
  TimedRun run{
      tests::brick_surface(128, floor_side), without_rolling(0.7), {ball_radius, without_rolling(0.9)}};
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

TEST_CASE("a bouncing ball keeps the energy that restitution leaves: each apex is e^2 of the one before") {
  const auto plane = tests::made_surface(
      16, [](Vec2) { return 0.0; }, [](Vec2) { return Vec3(0, 0, 1); }, 0.001,
      tests::flat_placement(floor_side));
  for (const int rate : {240, 480, 960}) {
    for (const double restitution : {0.7, 0.95}) {
      CAPTURE(rate);
      CAPTURE(restitution);
      WorldOptions options;
      options.step = 1.0 / rate;
      World world(plane, without_rolling(restitution), options);
      world.add(dynamics::SphereBody{ball_radius, without_rolling(restitution), {0, ball_radius + 0.3, 0}});
      double before = 0.3, highest = 0, worst = 0;
      int apexes = 0;
      for (bool rose = false; before > 0.01;) {
        world.step();
        const double height = world.pose(1).position.y() - ball_radius;
        const bool rises = world.velocity(1).y() > 0;
        if (rises || rose) highest = std::max(highest, height);
        if (rose && !rises) {
          // Two materials.
          worst = std::max(worst, std::abs(highest / (std::pow(restitution, 4) * before) - 1));
          before = highest;
          highest = 0;
          ++apexes;
        }
        rose = rises;
      }
      MESSAGE(rate << " Hz: " << apexes << " apexes, off by " << 100 * worst << " % at most");
      CHECK(apexes >= 3);
      CHECK(worst < (rate < 480 ? 0.05 : 0.01));
    }
  }
}
