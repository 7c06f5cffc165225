#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "core/portable_math.h"
#include "haptics/servo.h"
#include "intaglio/representation.h"
#include "tests/haptics/closed_loops.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::haptics;

namespace {

constexpr double spring_stiffness = 800, path_speed = 0.05;  // N/m, m/s

struct Table {
  std::string method;
  double worst = -1e9, least = 1e9, mean = 0;

  void add(double work, int of) {
    worst = std::max(worst, work);
    least = std::min(least, work);
    mean += work / of;
  }
};

}  // namespace

TEST_CASE("on 400 closed loops contact gives the hand no energy; the paper's planes do" *
          doctest::test_suite("statistics")) {
  const auto s = tests::brick_surface(512, 0.1);
  const TexturedSlab slab(s, {Representation::relief, 0.001, 0.02});
  const auto k = ContactSprings::for_felt_stiffness(spring_stiffness);
  Random random(7);
  Table conservative{"potential"}, lossy{"potential, friction 0.4, damping 1"},
      plane{"plane at 60 Hz, Eq. 1.3"}, literal{"normals on the flat base, every tick"};
  const int loops = tests::poses(400, 400);
  for (int n = 0; n < loops; ++n) {
    const auto path = tests::closed_loop(*s, random, 10e-6);
    // Where the proxy slips over an edge the force jumps; the quadrature is off by at most half the jump
    // times the step.
    const auto fine = tests::refined(path, 10);
    Proxy proxy, rubbing;
    conservative.add(tests::work_round(
                         fine, path_speed,
                         [&](const Vec3& x, const Vec3&, double) { return proxy.move(slab, x, k, 0).force; }),
                     loops);
    lossy.add(tests::work_round(path, path_speed,
                                [&](const Vec3& x, const Vec3& v, double) {
                                  const auto c = rubbing.move(slab, x, k, 0.4);
                                  const double push = c.force.dot(c.normal);
                                  return Vec3(c.force + std::max(-push, -1.0 * v.dot(c.normal)) * c.normal);
                                }),
              loops);
    for (Table* row : {&plane, &literal}) {
      const bool is_plane = row == &plane;
      HeldPlane held(is_plane ? 60 : 1e9);
      row->add(tests::work_round(path, path_speed,
                                 [&](const Vec3& x, const Vec3& v, double dt) {
                                   return held
                                       .move(*s, is_plane ? Representation::relief : Representation::normal,
                                             x, v, {spring_stiffness, 0}, dt)
                                       .force;
                                 }),
               loops);
    }
  }
  for (const Table& row : {conservative, lossy, plane, literal}) {
    MESSAGE(row.method << ": work on the hand a loop, worst " << 1e3 * row.worst << " mJ, mean "
                       << 1e3 * row.mean << " mJ, least " << 1e3 * row.least << " mJ");
  }
  CHECK(conservative.worst <= 1e-6);
  CHECK(lossy.worst <= 0);
  CHECK(plane.worst > 1e-4);
  CHECK(literal.worst > 1e-4);
}

TEST_CASE("the whole servo loop at 1 kHz with 23 um encoders gives the hand no energy") {
  // Work is exactly the force held times the true displacement.
  struct Led : Device {
    Vec3 position = Vec3::Zero(), force = Vec3::Zero();
    Vec3 read() override { return (position / 2.3e-5).array().round().matrix() * 2.3e-5; }
    void write(const GuardedForce& f) override { force = f.newtons(); }
  };
  const auto s = tests::brick_surface(512, 0.1);
  constexpr int loops = 100;
  for (const bool controlled : {true, false}) {
    for (const double friction : {0.0, 0.4}) {
      Random random(7);
      Table table{"friction " + std::to_string(friction) + (controlled ? ", controller" : ", no controller")};
      for (int n = 0; n < loops; ++n) {
        const auto path = tests::closed_loop(*s, random, path_speed * 1e-3);
        Led device;
        ServoOptions options;
        options.spring = {spring_stiffness, friction > 0 ? 1.0 : 0.0};
        options.friction = friction;
        options.passivity = controlled;
        options.pen.tip_radius = 0.0005;
        options.limits.continuous_force = options.limits.peak_force = 1e3;
        options.limits.slew_rate = 1e7;
        PenServo servo(s, options);
        for (int k = 0; k < 600; ++k) device.position = path[0], servo.tick(device);
        // The second round counts.
        double work = 0;
        for (int round = 0; round < 2; ++round) {
          work = 0;
          for (std::size_t k = 1; k < path.size(); ++k) {
            work += device.force.dot(path[k] - path[k - 1]);
            device.position = path[k];
            servo.tick(device);
          }
        }
        table.add(work, loops);
      }
      MESSAGE(table.method << ": work on the hand a loop, worst " << 1e3 * table.worst << " mJ, mean "
                           << 1e3 * table.mean << " mJ");
      if (controlled && friction > 0) CHECK(table.worst <= 0);
    }
  }
}
