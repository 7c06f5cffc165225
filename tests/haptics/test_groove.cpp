#include <doctest/doctest.h>

#include <cmath>

#include "haptics/device.h"
#include "haptics/servo.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::haptics;

namespace {

// A V-groove along +v in the middle of a flat square of 40 mm, walls `degrees` steep, 8 mm wide.
std::shared_ptr<const surface::Surface> groove(double degrees) {
  constexpr double side = 0.04, half_width = 0.004;
  const double slope = std::tan(degrees * 3.14159265358979323846 / 180), depth = slope * half_width;
  const auto across = [](Vec2 uv) { return (uv.x() - 0.5) * side; };
  return tests::made_surface(
      400, [&](Vec2 uv) { return std::max(0.0, 1 - std::abs(across(uv)) / half_width); },
      [&](Vec2 uv) {
        const double x = across(uv);
        return std::abs(x) < half_width ? Vec3(x > 0 ? -slope : slope, 0, 1) : Vec3(0, 0, 1);
      },
      depth, tests::flat_placement(side), surface::Edge::clamp);
}

struct Buzz {
  double lateral = 0;      // m/s, root mean square
  double over_static = 0;  // peak force over its mean while resting
};

// A hand of 0.08 kg lowers the tip onto a wall of the groove and presses into it, slightly off the middle.
Buzz press(const std::shared_ptr<const surface::Surface>& s, double depth, HapticMethod method, double rate,
           const Hand& hand) {
  ServoOptions options;
  options.method = method;
  options.rate = rate;
  options.spring = {800, 1};
  options.friction = 0;
  options.pen.tip_radius = 0.0005;
  options.passivity = method == HapticMethod::potential;
  const double press = -depth - 0.008;
  SimulatedDevice device({2.3e-5, {0.16, 0.12, 0.12}, 7.9, rate}, hand,
                         {{0, {0.0015, 0.003, 0}}, {1, {0.0002, press, 0}}, {4, {0.0002, press, 0}}});
  PenServo servo(s, options);
  double sum = 0, mean = 0, peak = 0;
  int n = 0;
  const int substeps = int(16000 / rate);
  for (int k = 0; k < int(4 * rate); ++k) {
    const ServoSample sample = servo.tick(device);
    for (int m = 0; m < substeps; ++m) {
      const double before = device.position().x();
      device.advance(1 / rate / substeps);
      if (k >= 2 * rate) sum += std::pow((device.position().x() - before) * rate * substeps, 2) / substeps;
    }
    peak = std::max(peak, sample.force.norm());
    if (k < 2 * rate) continue;
    mean += sample.force.y();
    ++n;
  }
  return {std::sqrt(sum / n), peak / (mean / n)};
}

}  // namespace

TEST_CASE("in a V-groove the tip rests at any damping of the hand; on the paper's planes it buzzes") {
  for (const double degrees : {30.0, 45.0}) {
    const auto s = groove(degrees);
    for (const double rate : {1000.0, 4000.0}) {
      for (const double damping : {6.0, 0.5, 0.0}) {
        const Hand hand{0.08, 200, damping};
        const Buzz ours = press(s, s->max_depth(), HapticMethod::potential, rate, hand);
        const Buzz plane = press(s, s->max_depth(), HapticMethod::plane, rate, hand);
        MESSAGE(degrees << " degrees, " << rate << " Hz, hand " << damping << " N s/m: buzz "
                        << 1e3 * ours.lateral << " mm/s (plane " << 1e3 * plane.lateral
                        << "), peak over static " << ours.over_static << " (plane " << plane.over_static
                        << ")");
        CHECK(ours.lateral <= (rate == 1000 ? 2e-3 : 1e-3));
        CHECK(ours.over_static <= 1.5);
        CHECK(plane.lateral > 20e-3);
      }
    }
  }
}
