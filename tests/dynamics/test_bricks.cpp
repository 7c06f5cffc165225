#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/dynamics/brick_scene.h"

using namespace intaglio;
using namespace intaglio::dynamics;
namespace scene = intaglio::tests::brick_scene;

namespace {

struct Run {
  std::vector<Vec3> at;        // the balls, at the end
  std::vector<double> depths;  // true penetration of every ball after every step, where there is any
  double gained = 0;           // sum of all rises of a ball's energy from step to step, J
  double seconds = 0;          // balls times time
};

enum class Watch { only_the_end, every_step };

Run run(const std::shared_ptr<const surface::Surface>& s, const std::vector<SphereBody>& balls,
        const WorldOptions& options, double duration, Watch watch = Watch::only_the_end) {
  World world = scene::world(s, options, balls);
  Run out;
  std::vector<double> before(balls.size());
  for (std::size_t k = 0; k < balls.size(); ++k) before[k] = scene::energy(world, BodyId(k + 1), balls[k]);
  const int steps = int(std::lround(duration / options.step));
  for (int n = 0; n < steps; ++n) {
    world.step();
    for (std::size_t k = 0; watch == Watch::every_step && k < balls.size(); ++k) {
      const auto id = BodyId(k + 1);
      const double now = scene::energy(world, id, balls[k]);
      out.gained += std::max(0.0, now - before[k]);
      before[k] = now;
      const auto nearest = closest_point(*s, s->placement().to_local(world.pose(id).position));
      out.depths.push_back(std::max(0.0, balls[k].radius - nearest->distance));
    }
  }
  out.seconds = double(balls.size()) * duration;
  for (std::size_t k = 0; k < balls.size(); ++k) out.at.push_back(world.pose(BodyId(k + 1)).position);
  return out;
}

double height_rms(const Run& a, const Run& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.at.size(); ++k) sum += std::pow(a.at[k].y() - b.at[k].y(), 2);
  return std::sqrt(sum / double(a.at.size()));
}

}  // namespace

TEST_CASE("T3, T4: balls on bricks agree with the same run at 3840 Hz, the better the higher the rate" *
          doctest::test_suite("statistics")) {
  const auto s = scene::floor(tests::quick_or_slow(256, 512));
  const auto balls = scene::balls(*s, tests::poses(25, 100));
  // The rate itself is tested, so no substeps.
  const auto at_rate = [](int rate) {
    WorldOptions out = scene::options(rate);
    out.most_substeps = 1;
    return out;
  };
  const Run fine = run(s, balls, at_rate(3840), 0.75);
  std::vector<double> errors;
  for (const int rate : {60, 240, 960}) {
    errors.push_back(height_rms(run(s, balls, at_rate(rate), 0.75), fine));
    MESSAGE("height RMS at " << rate << " Hz: " << 1000 * errors.back() << " mm");
  }
  CHECK(errors[2] <= 0.3e-3);
  CHECK(errors[0] >= 2 * errors[1]);
  CHECK(errors[1] >= 2 * errors[2]);
}

TEST_CASE("T5, T7: at 60 Hz and above balls on bricks gain no energy and stay outside" *
          doctest::test_suite("statistics")) {
  const auto s = scene::floor(tests::quick_or_slow(256, 512));
  const auto balls = scene::balls(*s, tests::poses(25, 100));
  const double mgr = balls[0].mass() * scene::gravity * scene::radius;
  for (const int rate : {60, 240, 960}) {
    Run watched = run(s, balls, scene::options(rate), 3, Watch::every_step);
    std::sort(watched.depths.begin(), watched.depths.end());
    const double p95 = watched.depths[watched.depths.size() * 95 / 100], deepest = watched.depths.back();
    const double gained = watched.gained / mgr / watched.seconds;
    MESSAGE(rate << " Hz: energy gained " << gained << " m g r a ball and second; penetration p95 "
                 << 1000 * p95 << " mm, max " << 1000 * deepest << " mm");
    CHECK(gained <= 1e-4);
    CHECK(p95 <= 0.1e-3);
    CHECK(deepest <= 1e-3);
  }
}

TEST_CASE("T6: balls come to rest where they do at 3840 Hz" * doctest::test_suite("statistics")) {
  const auto s = scene::floor(tests::quick_or_slow(256, 512));
  auto balls = scene::balls(*s, tests::poses(50, 400), 1, 6);
  // With rolling resistance, so that they stop.
  for (SphereBody& ball : balls) ball.material.rolling_resistance = 0.1;
  struct Rest {
    double in_mortar = 0, height = 0;
  };
  const auto rest = [&](int rate) {
    Rest out;
    // On a brick's face the centre is a radius above it; lower by a twentieth means between bricks.
    for (const Vec3& at : run(s, balls, scene::options(rate), 5).at) {
      out.in_mortar += at.y() < 0.95 * scene::radius ? 1.0 : 0.0;
      out.height += at.y();
    }
    out.in_mortar /= double(balls.size());
    out.height /= double(balls.size());
    return out;
  };
  const Rest fine = rest(3840);
  // With few balls, one that rests elsewhere is a per cent: only the full test checks the lower rates.
  for (const int rate : {60, 240, 960}) {
    const Rest here = rest(rate);
    MESSAGE(rate << " Hz: in mortar " << 100 * here.in_mortar << " %, mean height " << 1000 * here.height
                 << " mm; at 3840 Hz " << 100 * fine.in_mortar << " %, " << 1000 * fine.height << " mm");
    if (rate < tests::quick_or_slow(960, 240)) continue;
    CHECK(std::abs(here.in_mortar - fine.in_mortar) <= 0.02);
    CHECK(std::abs(here.height - fine.height) <= 0.5e-3);
  }
}
