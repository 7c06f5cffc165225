#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "core/portable_math.h"
#include "surface/closest.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::surface;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Squared distance of p to the line t = const of a cell: a parabola in s, hence exact.
double line_distance2(const Cell& cell, const Vec3& p, double t) {
  const Vec3 a = cell.at(0, t), d = cell.at(1, t) - a;
  return (a + std::clamp(d.dot(p - a) / d.squaredNorm(), 0.0, 1.0) * d - p).squaredNorm();
}

// Brute force for one cell: its lines t = const are scanned, and each dip refined by golden section.
double brute_cell_distance2(const Cell& cell, const Vec3& p) {
  constexpr int n = 32;
  std::array<double, n + 1> at;
  for (int k = 0; k <= n; ++k) at[std::size_t(k)] = line_distance2(cell, p, double(k) / n);
  double best = *std::min_element(at.begin(), at.end());
  for (int k = 0; k <= n; ++k) {
    if ((k > 0 && at[std::size_t(k - 1)] < at[std::size_t(k)]) ||
        (k < n && at[std::size_t(k + 1)] < at[std::size_t(k)]))
      continue;
    double low = std::max(0.0, (k - 1.0) / n), high = std::min(1.0, (k + 1.0) / n);
    for (int round = 0; round < 40; ++round) {
      const double a = high - 0.618033988749895 * (high - low), b = low + 0.618033988749895 * (high - low);
      (line_distance2(cell, p, a) < line_distance2(cell, p, b) ? high : low) =
          line_distance2(cell, p, a) < line_distance2(cell, p, b) ? b : a;
    }
    best = std::min(best, line_distance2(cell, p, 0.5 * (low + high)));
  }
  return best;
}

double box_distance2(const Cell& cell, const Vec3& p) {
  const auto away = [](double x, double low, double high) { return std::max({low - x, x - high, 0.0}); };
  const double x = away(p.x(), cell.x0, cell.x1), y = away(p.y(), cell.y0, cell.y1),
               z = away(p.z(), cell.min_z(), cell.max_z());
  return x * x + y * y + z * z;
}

// Every cell within a side and a half of the rectangle.
double brute_distance(const surface::Surface& s, const Vec3& p) {
  const auto [under_i, under_j] = s.cell_at(p.x(), p.y());
  double best2 = brute_cell_distance2(s.cell(under_i, under_j), p);
  for (int j = -s.height() - 2; j <= 2 * s.height() + 2; ++j) {
    for (int i = -s.width() - 2; i <= 2 * s.width() + 2; ++i) {
      const Cell cell = s.cell(i, j);
      if (box_distance2(cell, p) < best2) best2 = std::min(best2, brute_cell_distance2(cell, p));
    }
  }
  return std::sqrt(best2);
}

// Over, in and beside the rectangle; most of them near the relief.
Vec3 random_pose(const surface::Surface& s, Random& random) {
  const double above = random.uniform() < 0.7 ? 0.05 : 0.5;
  return {random.uniform(-0.2, 1.2) * s.placement().size_u(),
          random.uniform(-0.2, 1.2) * s.placement().size_v(), random.uniform(-2 * s.max_depth(), above)};
}

// By how much the relief on a small ring around `point`, with a radius in texels, is nearer than `point`.
double nearer_around(const surface::Surface& s, const Vec3& p, const Vec3& point, double texels) {
  double least = infinity;
  for (int k = 0; k < 32; ++k) {
    const double angle = k * 0.19634954, ring = texels * std::min(s.texel_u(), s.texel_v());
    Vec3 q = point + ring * Vec3(std::cos(angle), std::sin(angle), 0);
    q.z() = -s.depth(s.placement().uv(q));
    least = std::min(least, (q - p).norm());
  }
  return (point - p).norm() - least;
}

}  // namespace

TEST_CASE("the nearest point of a cell is the one a scan finds, for every kind of cell") {
  Random random(10);
  double worst = 0;
  const int count = tests::poses(20000, 1000000);
  for (int k = 0; k < count; ++k) {
    const double height = std::pow(10.0, random.uniform(-4, 1)),
                 away = std::pow(10.0, random.uniform(-2, 1.5));
    const double w = random.uniform(0.3, 3), h = random.uniform(0.3, 3);
    Cell cell{0, 0, w, h, {}};
    for (double& z : cell.z) z = random.uniform(-height, height);
    const Vec3 p(random.uniform(-1, 2) * w, random.uniform(-1, 2) * h, random.uniform(-away, away));
    const Vec2 st = tests::closest_on_cell(cell, p);
    CHECK((st.minCoeff() >= 0 && st.maxCoeff() <= 1));
    worst = std::max(worst, (cell.at(st.x(), st.y()) - p).norm() - std::sqrt(brute_cell_distance2(cell, p)));
  }
  MESSAGE(count << " cells, worst disagreement with a scan: " << worst << " cells");
  CHECK(worst < 1e-6);
}

TEST_CASE("the closest point is as near as brute force finds, whatever size and edge") {
  const auto surfaces = tests::various_surfaces();
  const int count = tests::poses(1500) / int(surfaces.size()) + 1;
  double worst = 0;
  for (std::size_t n = 0; n < surfaces.size(); ++n) {
    const surface::Surface& s = *surfaces[n];
    Random random(100 + n);
    for (int k = 0; k < count; ++k) {
      const Vec3 p = random_pose(s, random);
      const auto feature = closest_point(s, p);
      REQUIRE(feature);
      worst = std::max(worst, std::abs(std::abs(feature->distance) - brute_distance(s, p)));
      CHECK(std::abs(feature->distance) == doctest::Approx((p - feature->point).norm()).epsilon(1e-9));
      CHECK(feature->point.z() == doctest::Approx(-s.depth(s.placement().uv(feature->point))).epsilon(1e-9));
      CHECK((p - feature->point - feature->distance * feature->direction).norm() < 1e-9);
      CHECK((feature->distance < 0) == (p.z() < -s.depth(s.placement().uv(p))));
    }
  }
  MESSAGE((count * surfaces.size()) << " poses, worst disagreement with brute force: " << worst
                                    << " of a side of 1 m");
  CHECK(worst < 1e-6);
}

TEST_CASE("the first feature is the closest point, or there is none within reach") {
  for (const auto& s : tests::various_surfaces()) {
    Random random(13);
    for (int k = 0; k < 300; ++k) {
      const Vec3 p = random_pose(*s, random);
      const double reach = random.uniform(0.01, 0.1);
      std::array<Feature, 4> features;
      const std::size_t found = closest_features(*s, p, reach, 0.35, features);
      const auto nearest = closest_point(*s, p);
      REQUIRE(nearest);
      CHECK((found > 0) == (std::abs(nearest->distance) < reach));
      if (found > 0) CHECK(features[0].distance == nearest->distance);
    }
  }
}

TEST_CASE("features are local minima on the relief, nearest first, and their directions differ") {
  for (const auto& s : tests::various_surfaces()) {
    Random random(12);
    for (int k = 0; k < 300; ++k) {
      const Vec3 p = random_pose(*s, random);
      std::array<Feature, 4> features;
      const std::size_t found = closest_features(*s, p, 0.06, 0.35, features);
      for (std::size_t a = 0; a < found; ++a) {
        CHECK(features[a].point.z() ==
              doctest::Approx(-s->depth(s->placement().uv(features[a].point))).epsilon(1e-9));
        CHECK(nearer_around(*s, p, features[a].point, 1e-6) < 1e-9 * std::min(s->texel_u(), s->texel_v()));
        CHECK(std::abs(features[a].distance) < 0.06);
        for (std::size_t b = a + 1; b < found; ++b) {
          CHECK(std::abs(features[a].distance) <= std::abs(features[b].distance));
          CHECK(features[a].direction.dot(features[b].direction) <= std::cos(0.35) + 1e-12);
        }
      }
    }
  }
}

TEST_CASE("no local minimum within reach is missing unless a nearer feature has its direction") {
  const double reach = 0.06, min_angle = 0.35;
  const auto surfaces = tests::various_surfaces();
  const int count = tests::poses(60, 100000 / int(surfaces.size()));
  int several = 0;
  for (const auto& s : surfaces) {
    Random random(14);
    for (int k = 0; k < count; ++k) {
      const Vec3 p = random_pose(*s, random);
      const double sign = p.z() < -s->depth(s->placement().uv(p)) ? -1 : 1;
      std::array<Feature, 16> features;
      const std::size_t found = closest_features(*s, p, reach, min_angle, features);
      several += found > 1;
      const auto [i0, j0] = s->cell_at(p.x() - reach, p.y() - reach);
      const auto [i1, j1] = s->cell_at(p.x() + reach, p.y() + reach);
      for (int j = j0; j <= j1; ++j) {
        for (int i = i0; i <= i1; ++i) {
          const Cell cell = s->cell(i, j);
          if (box_distance2(cell, p) >= reach * reach) continue;
          const Vec2 st = tests::closest_on_cell(cell, p);
          const Vec3 point = cell.at(st.x(), st.y()), apart = p - point;
          const double length = apart.norm();
          const Vec3 direction = sign * apart / length;
          if (length >= reach - 1e-9 || direction.dot(cell.normal(st.x(), st.y())) < 1e-6 ||
              nearer_around(*s, p, point, 1e-3) > -1e-12)
            continue;
          CHECK(
              std::any_of(features.begin(), features.begin() + std::ptrdiff_t(found), [&](const Feature& f) {
                return std::abs(f.distance) <= length + 1e-9 &&
                       f.direction.dot(direction) > std::cos(min_angle) - 1e-6;
              }));
        }
      }
    }
  }
  MESSAGE(several << " poses with several features");
  CHECK(several > 10);
}

TEST_CASE("over a plane there is one feature, straight below, of either sign, however far the reach") {
  for (const surface::Edge edge : {surface::Edge::wrap, surface::Edge::clamp}) {
    const auto s = tests::made_surface(
        16, [](Vec2) { return 0.5; }, [](Vec2) { return Vec3::UnitZ(); }, 0.02, tests::flat_placement(),
        edge);
    for (const double height : {0.03, -0.004}) {
      for (const double reach : {0.05, 0.4}) {
        std::array<Feature, 4> features;
        REQUIRE(closest_features(*s, {0.4, 0.6, -0.01 + height}, reach, 0.35, features) == 1);
        CHECK(features[0].distance == doctest::Approx(height));
        CHECK(features[0].direction.z() == doctest::Approx(1));
      }
    }
  }
}

TEST_CASE("without a depth map the relief is the plane z = 0") {
  Texels texels;
  texels.width = texels.height = 2;
  texels.normal.assign(4, Vec3::UnitZ());
  const surface::Surface s(std::move(texels), tests::flat_placement(), 0.02, surface::Edge::wrap);
  std::array<Feature, 4> features;
  for (const double height : {0.03, -0.03}) {
    REQUIRE(closest_features(s, {0.4, 0.6, height}, 0.05, 0.35, features) == 1);
    CHECK(features[0].distance == height);
    CHECK(features[0].point == Vec3(0.4, 0.6, 0));
    CHECK(features[0].direction == Vec3::UnitZ());
    CHECK(closest_point(s, {0.4, 0.6, height})->distance == height);
  }
  CHECK(closest_features(s, {0.4, 0.6, 0.06}, 0.05, 0.35, features) == 0);
}

TEST_CASE("in a groove both walls are found") {
  // A V of 45 degrees along v; the sphere's centre over its middle sees both walls.
  const auto s = tests::made_surface(
      100, [](Vec2 uv) { return std::max(0.0, 1 - std::abs(uv.x() - 0.5) / 0.02); },
      [](Vec2) { return Vec3::UnitZ(); }, 0.02);
  std::array<Feature, 4> features;
  const std::size_t found = closest_features(*s, {0.5, 0.5, 0.01}, 0.04, 0.35, features);
  REQUIRE(found >= 2);  // and the bottom between them
  CHECK(features[0].direction.x() * features[1].direction.x() < 0);
  CHECK(features[0].distance == doctest::Approx(features[1].distance).epsilon(0.02));
}

TEST_CASE("wrap is seamless: the closest point moves along with the point, by whole sides") {
  const auto s = tests::rough_surface(37, 53, surface::Edge::wrap);
  Random random(15);
  for (int k = 0; k < 1000; ++k) {
    const Vec3 p = random_pose(*s, random);
    const int a = int(random.uniform(-4, 4)), b = int(random.uniform(-4, 4));
    const Vec3 shift(a * s->placement().size_u(), b * s->placement().size_v(), 0);
    const auto here = closest_point(*s, p), there = closest_point(*s, p + shift);
    REQUIRE((here && there));
    CHECK(here->distance == doctest::Approx(there->distance).epsilon(1e-9));
    if ((here->point + shift - there->point).norm() < 1e-6) {
      const Cell cell = s->cell(there->cell_i, there->cell_j);
      CHECK(box_distance2(cell, there->point) < 1e-18);
    }
  }
}

// Wrapped, of a width that leaves a block of one column at the seam, with the steepest step there.
std::shared_ptr<const surface::Surface> stepped(int width, int height, int rolled) {
  Texels texels;
  texels.width = width;
  texels.height = height;
  for (int j = 0; j < height; ++j) {
    Random random(std::uint64_t(1000 + j));
    std::vector<double> rough;
    for (int i = 0; i < width; ++i) rough.push_back(random.uniform());
    for (int i = 0; i < width; ++i) {
      const int from = (i + width - rolled) % width;
      const double step = from == 0 ? 1 : from == 1 ? 0.5 : 0;
      texels.depth.push_back(float(0.97 * step + 0.03 * rough[std::size_t(from)]));
      texels.normal.push_back(Vec3::UnitZ());  // unused here
    }
  }
  const Placement place(Vec3::Zero(), Quat::Identity(), 0.01 * width, 0.01 * height);
  return std::make_shared<const surface::Surface>(std::move(texels), place, 0.1, surface::Edge::wrap);
}

TEST_CASE("features do not depend on where the texture begins, whatever the size of its last block") {
  int second = 0;
  for (const int width : {64, 65, 100, 129}) {
    const int roll = width / 2;
    const auto s = stepped(width, 64, 0), rolled = stepped(width, 64, roll);
    Random random(9);
    double worst = 0;
    for (int k = 0; k < 1500; ++k) {
      const Vec3 p(random.uniform(-0.1, 0.1), random.uniform(0, 0.64), random.uniform(-0.05, 0.1));
      std::array<Feature, 4> here, there;
      const std::size_t n = closest_features(*s, p, 0.3, 0.35, here);
      const std::size_t m = closest_features(*rolled, p + Vec3(0.01 * roll, 0, 0), 0.3, 0.35, there);
      REQUIRE(n == m);
      for (std::size_t f = 0; f < n; ++f)
        worst = std::max(worst, std::abs(here[f].distance - there[f].distance));
      second += n > 1 ? 1 : 0;
    }
    CHECK(worst < 1e-9);
  }
  CHECK(second > 3000);
}

TEST_CASE("far beyond a border the outermost cells extend") {
  const auto surfaces = tests::various_surfaces();
  for (const auto& s : surfaces) {
    if (s->edge() != surface::Edge::clamp) continue;
    Random random(10);
    for (const double x : {9e6, 1.1e7, 1e8}) {
      for (int k = 0; k < 50; ++k) {
        const Vec3 p(0, random.uniform(0, 1) * s->placement().size_v(), random.uniform(-0.03, 0.05));
        // Beyond a border the relief only depends on the other coordinate: everywhere the same.
        const auto near = closest_point(*s, p + Vec3(5 * s->placement().size_u() + 1, 0, 0)),
                   far = closest_point(*s, p + Vec3(x, 0, 0));
        REQUIRE((near && far));
        CHECK(far->distance == doctest::Approx(near->distance).epsilon(1e-7));
      }
    }
  }
}

TEST_CASE("from near to far above, where bounds go from single to double precision, the nearest is nearest") {
  double worst = 0;
  for (const auto& s : tests::various_surfaces()) {
    Random random(31);
    for (const double z : {1.0, 3.0, 10.0, 30.0, 100.0, 1000.0}) {
      for (int k = 0; k < 3; ++k) {
        const Vec3 p(random.uniform(0, 1) * s->placement().size_u(),
                     random.uniform(0, 1) * s->placement().size_v(), z * random.uniform(0.7, 1));
        worst = std::max(worst, std::abs(closest_point(*s, p)->distance - brute_distance(*s, p)));
      }
    }
  }
  MESSAGE("worst disagreement with brute force: " << worst << " m");
  CHECK(worst < 1e-9);
}

TEST_CASE("NaN points and points a million metres away are answered at once and correctly") {
  std::array<Feature, 4> features;
  for (const auto& s : tests::various_surfaces()) {
    CHECK(closest_features(*s, Vec3(std::nan(""), 0, 0), 0.1, 0.35, features) == 0);
    CHECK(closest_features(*s, Vec3(0, 0, 1e6), 0.1, 0.35, features) == 0);
    CHECK_FALSE(closest_point(*s, Vec3(0, std::nan(""), 0)));
    CHECK_FALSE(closest_point(*s, Vec3(infinity, 0, 0)));
    // From high up the nearest point is one of the highest.
    const double top = -s->max_depth() * s->pyramid().total_range().shallow;
    CHECK(std::abs(closest_point(*s, {0.3, 0.3, 1e6})->distance - (1e6 - top)) < 1e-6);
    // Far aside there is relief of the same height as at the edge, or as here.
    for (const double far : {1e6, -1e6}) {
      const auto feature = closest_point(*s, {far + 0.3, 0.3, 0.05});
      REQUIRE(feature);
      CHECK(std::abs(feature->point.x() - far) < 2);
      CHECK(feature->distance <= 0.05 + s->max_depth());
      CHECK(closest_features(*s, {far + 0.3, 0.3, 0.05}, 0.2, 0.35, features) >= 1);
    }
  }
}
