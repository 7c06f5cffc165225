// A rolling textured ball turns its texture into a tone.
#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "tests/dynamics/curved_world.h"

using namespace intaglio;
using std::numbers::pi;
using tests::CurvedWorld;
using tests::vec;

namespace {

constexpr double ridged_radius = 0.1, sample_rate = 960, measured_seconds = 4;
constexpr int ridge_count = 24;  // around the equator

// `ridge_count` ridges around, 0.2 mm from top to bottom.
surface::ReliefMesh ridged_ball() {
  const auto ridges = tests::made_surface(
      768, [](Vec2 uv) { return 0.5 - 0.5 * std::cos(2 * pi * ridge_count * uv.x()); },
      [](Vec2) { return Vec3::UnitZ(); }, 0.2e-3);
  return tests::relief_on(surface::make_sphere(ridged_radius, 768, 96), ridges);
}

// A floor of 12 m.
std::shared_ptr<const surface::Surface> floor_of(int n, const std::function<double(Vec2)>& depth,
                                                 double max_depth) {
  return tests::made_surface(
      n, depth, [](Vec2) { return Vec3::UnitZ(); }, max_depth, tests::flat_placement(12));
}

struct Rolled {
  std::vector<double> height, force;  // m; m/s^2 of its mass, gravity's apart
  double speed;                       // m/s, mean
};

// Rolls along +X on its equator from -3 m, after a tenth of a second to settle; a gentle pull keeps its speed
// over the ridges.
Rolled roll(std::shared_ptr<const surface::Surface> floor, double speed) {
  CurvedWorld plain(std::move(floor));
  plain.add_rolling(0, plain.shape, Vec3::Zero());
  dynamics::CurvedShape ball(ridged_ball());
  btRigidBody& body = plain.add_rolling(1, ball, Vec3(-3, ridged_radius + 1e-4, 0));
  // Its axis, Y, lies along Z.
  body.getWorldTransform().setRotation(btQuaternion(btVector3(1, 0, 0), btScalar(pi / 2)));
  body.setLinearVelocity({btScalar(speed), 0, 0});
  body.setAngularVelocity({0, 0, btScalar(-speed / ridged_radius)});
  Rolled out;
  const int settling = int(0.1 * sample_rate), steps = int(measured_seconds * sample_rate);
  double from = 0, last = 0;
  for (int k = 0; k < settling + steps; ++k) {
    if (k == settling) from = vec(body.getWorldTransform().getOrigin()).x();
    last = vec(body.getLinearVelocity()).y();
    body.applyCentralForce({btScalar(20 * (speed - vec(body.getLinearVelocity()).x())), 0, 0});
    plain.world.stepSimulation(btScalar(1 / sample_rate), 0);
    if (k < settling) continue;
    out.height.push_back(vec(body.getWorldTransform().getOrigin()).y());
    out.force.push_back((vec(body.getLinearVelocity()).y() - last) * sample_rate);
  }
  out.speed = (vec(body.getWorldTransform().getOrigin()).x() - from) / measured_seconds;
  CHECK(std::abs(vec(body.getWorldTransform().getOrigin()).z()) < 0.3);
  return out;
}

// Amplitude at a frequency, with a Hann window.
double amplitude(const std::vector<double>& signal, double frequency) {
  double mean = 0;
  for (const double x : signal) mean += x / double(signal.size());
  std::complex<double> sum = 0;
  for (std::size_t k = 0; k < signal.size(); ++k) {
    const double window = 1 - std::cos(2 * pi * double(k) / double(signal.size()));
    sum += window * (signal[k] - mean) * std::polar(1.0, -2 * pi * frequency * double(k) / sample_rate);
  }
  return 2 * std::abs(sum) / double(signal.size());
}

// The frequency of the greatest amplitude; the resolution is 1 / measured_seconds, the place of a peak is
// finer.
double peak(const std::vector<double>& signal, double low, double high) {
  double best = low, most = 0;
  for (double f = low; f <= high; f += 0.1 / measured_seconds) {
    const double here = amplitude(signal, f);
    if (here <= most) continue;
    most = here;
    best = f;
  }
  return best;
}

}  // namespace

TEST_CASE("a textured ball that rolls on a flat floor makes noise with the period of its texture" *
          doctest::test_suite("statistics")) {
  const auto flat = floor_of(
      4, [](Vec2) { return 0.0; }, 0);
  for (const double speed : {0.5, 1.0}) {
    const Rolled rolled = roll(flat, speed);
    const double expected = ridge_count * rolled.speed / (2 * pi * ridged_radius);
    const double height = peak(rolled.height, 0.25 * expected, 4 * expected),
                 force = peak(rolled.force, 0.25 * expected, 4 * expected);
    MESSAGE(speed << " m/s (mean " << rolled.speed << "): N v / 2 pi R = " << expected
                  << " Hz; height peaks at " << height << " Hz (" << 1e6 * amplitude(rolled.height, height)
                  << " um), force at " << force << " Hz (" << amplitude(rolled.force, force) << " m/s^2)");
    CHECK(std::abs(height / expected - 1) < 0.01);
    CHECK(std::abs(force / expected - 1) < 0.01);
    CHECK(rolled.speed == doctest::Approx(speed).epsilon(0.05));
    // The ridges are followed: half their height, give or take what the ball bridges.
    CHECK(amplitude(rolled.height, height) == doctest::Approx(1e-4).epsilon(0.25));
  }
}
