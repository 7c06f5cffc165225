#include <doctest/doctest.h>

#include <algorithm>

#include "core/portable_math.h"
#include "tests/contact/bodies.h"
#include "tests/contact/brute.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::contact;

namespace {

// The height by which a body at the base plane must be lifted to be out of the relief, rounded up to 0.1 mm,
// by brute force.
double lift(const surface::Surface& s, const Shape& shape, const Pose& pose) {
  double low = 0, high = 0.3;  // across it, far above it
  while (high - low > 1e-4) {
    const double middle = 0.5 * (low + high);
    const Pose at{pose.position + middle * s.placement().n(), pose.orientation};
    (tests::brute_distance(s, shape, at, 1e-6) > -1e-7 ? high : low) = middle;
  }
  return high;
}

}  // namespace

TEST_CASE("no contact of a convex body is deeper than twice the way up and out" *
          doctest::test_suite("statistics")) {
  const int count = tests::poses(6, 2000);
  double worst = 0;
  for (const auto& s : {tests::brick_surface(128), tests::rough_surface(96, 80, surface::Edge::wrap)}) {
    const surface::Placement& place = s->placement();
    for (const char* name : {"box", "hull", "cylinder", "capsule"}) {
      const tests::Body body = tests::body(name, 0.15);
      Random random(41);
      for (int k = 0; k < count; ++k) {
        Pose pose{place.to_world({random.uniform(0.3, 0.7) * place.size_u(),
                                  random.uniform(0.3, 0.7) * place.size_v(), 0}),
                  tests::any_turn(random)};
        // Every other pose lies flat: those have edges along walls.
        if (k % 2 != 0) {
          pose.orientation = Quat(Eigen::AngleAxisd(random.uniform(0, 6), place.n()) *
                                  Eigen::AngleAxisd(random.uniform(-0.05, 0.05), place.t()));
        }
        const double overlap = random.uniform(0.0005, 0.008);
        pose.position += (lift(*s, body.shape, pose) - overlap) * place.n();
        // A fast body has a large margin.
        const double margin = random.uniform() < 0.5 ? 0.002 : 0.03;
        for (const ContactPoint& c : relief_contacts(*s, body.shape, pose, margin))
          worst = std::max(worst, -c.distance / overlap);
      }
    }
  }
  MESSAGE("at worst " << worst << " times as deep as the way up and out");
  CHECK(worst > 0.5);
  CHECK(worst < 2);
}
