#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "intaglio/core/random.h"
#include "intaglio/surface/closest.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::surface;

namespace {

// The independent way: a fine grid of each patch in reach, refined around its best point.
double brute_force(const Surface& s, const Vec3& p, double reach) {
  double best = reach;
  const auto [i0, j0] = s.cell_at(p.x() - reach, p.y() - reach);
  const auto [i1, j1] = s.cell_at(p.x() + reach, p.y() + reach);
  for (int j = j0; j <= j1; ++j) {
    for (int i = i0; i <= i1; ++i) {
      const Cell cell = s.cell(i, j);
      Vec2 low(0, 0), high(1, 1);
      for (int level = 0; level < 12; ++level) {
        Vec2 at = low;
        double nearest = 1e9;
        for (int a = 0; a <= 8; ++a) {
          for (int b = 0; b <= 8; ++b) {
            const Vec2 st = low + Vec2(a / 8.0, b / 8.0).cwiseProduct(high - low);
            const double d = (cell.at(st.x(), st.y()) - p).norm();
            if (d < nearest) {
              nearest = d;
              at = st;
            }
          }
        }
        if (level == 0 && nearest > best + 0.25 * std::hypot(cell.width(), cell.height())+ (cell.max_z() - cell.min_z())) break;
        best = std::min(best, nearest);
        const Vec2 half = 0.2 * (high - low);
        low = (at - half).cwiseMax(0);
        high = (at + half).cwiseMin(1);
      }
    }
  }
  return best;
}

}  // namespace

TEST_CASE("the closest feature is as near as a brute-force search finds") {
  const auto s = tests::brick_surface(64);
  Random random(11);
  double worst = 0;
  for (int k = 0; k < 400; ++k) {
    const Vec3 p(random.uniform(), random.uniform(), random.uniform(-0.015, 0.05));
    const double reach = 0.06;
    std::array<Feature, 4> features;
    const std::size_t found = closest_features(*s, p, reach, 0.35, features);
    const double brute = brute_force(*s, p, reach);
    if (brute >= reach) {
      CHECK(found == 0);
      continue;
    }
    REQUIRE(found > 0);
    worst = std::max(worst, std::abs(features[0].distance) - brute);
    CHECK(std::abs(std::abs(features[0].distance) - (p - features[0].point).norm()) < 1e-12);
  }
  MESSAGE("worst disagreement with brute force: " << worst << " m");
  CHECK(worst < 1e-6);
}

TEST_CASE("features are on the relief, nearest first, and their directions differ") {
  const auto s = tests::brick_surface(64);
  Random random(12);
  for (int k = 0; k < 400; ++k) {
    const Vec3 p(random.uniform(), random.uniform(), random.uniform(-0.005, 0.03));
    std::array<Feature, 4> features;
    const std::size_t found = closest_features(*s, p, 0.06, 0.35, features);
    for (std::size_t a = 0; a < found; ++a) {
      CHECK(features[a].point.z() == doctest::Approx(-s->depth(s->placement().uv(features[a].point))).epsilon(1e-9));
      for (std::size_t b = a + 1; b < found; ++b) {
        CHECK(std::abs(features[a].distance) <= std::abs(features[b].distance));
        CHECK(features[a].direction.dot(features[b].direction) <= std::cos(0.35) + 1e-12);
      }
    }
  }
}

TEST_CASE("over a plane there is one feature, straight below, of either sign") {
  const auto s = tests::made_surface(16, [](Vec2) { return 0.5; }, [](Vec2) { return Vec3::UnitZ(); });
  for (const double height : {0.03, -0.004}) {
    std::array<Feature, 4> features;
    const std::size_t found = closest_features(*s, {0.4, 0.6, -0.01 + height}, 0.05, 0.35, features);
    REQUIRE(found >= 1);
    CHECK(features[0].distance == doctest::Approx(height));
    CHECK(features[0].direction.z() == doctest::Approx(1));
  }
}

TEST_CASE("in a groove both walls are found") {
  // A V of 45 degrees along v; the sphere's centre over its middle sees both walls.
  const auto s = tests::made_surface(100, [](Vec2 uv) { return std::max(0.0, 1 - std::abs(uv.x() - 0.5) / 0.02); }, [](Vec2) { return Vec3::UnitZ(); }, 0.02);
  std::array<Feature, 4> features;
  const std::size_t found = closest_features(*s, {0.5, 0.5, 0.01}, 0.04, 0.35, features);
  REQUIRE(found >= 2);
  CHECK(features[0].direction.x() * features[1].direction.x() < 0);
  CHECK(features[0].distance == doctest::Approx(features[1].distance).epsilon(0.02));
}

TEST_CASE("a point that is not a number, or a million metres away, finds nothing and does not crash") {
  const auto s = tests::brick_surface(64);
  std::array<Feature, 4> features;
  CHECK(closest_features(*s, Vec3(std::nan(""), 0, 0), 0.1, 0.35, features) == 0);
  CHECK(closest_features(*s, Vec3(0, 0, 1e6), 0.1, 0.35, features) == 0);
}
