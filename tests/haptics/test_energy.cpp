#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tests/haptics/closed_loops.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::haptics;

namespace {

constexpr double stiffness = 800, speed = 0.05;  // N/m, m/s

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

TEST_CASE("400 closed loops: contact gives the hand no energy; the paper's planes do") {
  const auto s = tests::brick_surface(512, 0.1);
  const TexturedSlab slab(s, {Representation::relief, 0.001, 0.02});
  const auto k = ContactStiffness::felt(stiffness);
  Random random(7);
  Table conservative{"potential"}, lossy{"potential, friction 0.4, damping 1"},
      plane{"plane at 60 Hz, Eq. 1.3"}, literal{"normals on the flat base, every tick"};
  constexpr int loops = 400;
  for (int n = 0; n < loops; ++n) {
    const auto path = tests::closed_loop(*s, random, 10e-6);
    // Where the proxy slips over an edge the force jumps; the quadrature is off by at most half the jump
    // times the step.
    const auto fine = tests::refined(path, 10);
    Proxy proxy, rubbing;
    conservative.add(
        tests::work_round(
            fine, speed, [&](const Vec3& x, const Vec3&, double) { return proxy.move(slab, x, k, 0).force; }),
        loops);
    lossy.add(tests::work_round(path, speed,
                                [&](const Vec3& x, const Vec3& v, double) {
                                  const auto c = rubbing.move(slab, x, k, 0.4);
                                  const double push = c.force.dot(c.normal);
                                  return Vec3(c.force + std::max(-push, -1.0 * v.dot(c.normal)) * c.normal);
                                }),
              loops);
    for (Table* row : {&plane, &literal}) {
      const bool is_plane = row == &plane;
      HeldPlane held(is_plane ? 60 : 1e9);
      row->add(tests::work_round(path, speed,
                                 [&](const Vec3& x, const Vec3& v, double dt) {
                                   return held
                                       .move(*s, is_plane ? Representation::relief : Representation::normal,
                                             x, v, {stiffness, 0}, dt)
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
