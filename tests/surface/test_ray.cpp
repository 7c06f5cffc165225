#include <doctest/doctest.h>

#include <cmath>

#include "intaglio/core/random.h"
#include "intaglio/surface/ray.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::surface;

TEST_CASE("a ray's hit is on the relief and nothing is hit before it") {
  const auto s = tests::brick_surface(64);
  Random random(21);
  int hits = 0;
  for (int k = 0; k < 3000; ++k) {
    const Vec3 target(random.uniform(), random.uniform(), random.uniform(-0.02, 0));
    const Vec3 origin = target + Vec3(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(0.02, 0.4));
    const Vec3 direction = target - origin;
    const auto hit = intersect(*s, origin, direction, 0, 10);
    const double end = hit ? hit->t : 2.0;
    if (hit) {
      ++hits;
      CHECK(std::abs(hit->point.z() + s->depth(s->placement().uv(hit->point))) < 1e-9);
    }
    for (int n = 1; n < 200; ++n) {
      const Vec3 p = origin + direction * (end * n / 200.0 * (1 - 1e-9));
      if (s->placement().covers(p)) CHECK(p.z() + s->depth(s->placement().uv(p)) >= -1e-9);
      if (!s->placement().covers(p) && p.z() < 0) break;
    }
  }
  CHECK(hits > 2000);
}

TEST_CASE("straight down, the hit is the depth") {
  const auto s = tests::brick_surface(64);
  Random random(22);
  for (int k = 0; k < 1000; ++k) {
    const Vec2 uv(random.uniform(), random.uniform());
    const auto hit = intersect(*s, {uv.x(), uv.y(), 1}, {0, 0, -1}, 0, 10);
    REQUIRE(hit);
    CHECK(hit->t - 1 == doctest::Approx(s->depth(uv)).epsilon(1e-9));
  }
}

TEST_CASE("beside the rectangle, from below or with bad numbers nothing is hit") {
  const auto s = tests::brick_surface(64);
  CHECK_FALSE(intersect(*s, {1.5, 0.5, 1}, {0, 0, -1}, 0, 10));
  CHECK_FALSE(intersect(*s, {0.5, 0.5, 1}, {0, 0, 1}, 0, 10));
  CHECK_FALSE(intersect(*s, {0.5, 0.5, std::nan("")}, {0, 0, -1}, 0, 10));
  CHECK_FALSE(intersect(*s, {0.5, 0.5, 1}, {0, 0, 0}, 0, 10));
}
