#include <doctest/doctest.h>

#include <cmath>

#include "surface/texels.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::surface;

namespace {

struct Means {
  double depth = 0, second = 0;
  Vec2 slope = Vec2::Zero();
};

// Over level 0, from the surface's own texels.
Means means_of_texels(const surface::Surface& s) {
  const std::vector<float> depths = s.depth_texture();
  Means sum;
  for (int j = 0; j < s.height(); ++j) {
    for (int i = 0; i < s.width(); ++i) {
      const Vec2 slope = slope_of(s.texel_normal({(i + 0.5) / s.width(), (j + 0.5) / s.height()}));
      sum.depth += depths[s.grid().index(i, j)];
      sum.slope += slope;
      sum.second += slope.squaredNorm();
    }
  }
  const auto count = double(s.grid().size());
  return {sum.depth / count, sum.second / count, sum.slope / count};
}

Means means_of_level(const Mips& mips, int level) {
  const Grid& grid = mips.grid(level);
  Means sum;
  for (int j = 0; j < grid.height; ++j) {
    for (int i = 0; i < grid.width; ++i) {
      const Mips::Moments m = mips.texel(level, i, j);
      sum.depth += m.depth;
      sum.slope += m.slope;
      sum.second += m.slope.squaredNorm() + m.variance;
    }
  }
  const auto count = double(grid.size());
  return {sum.depth / count, sum.second / count, sum.slope / count};
}

}  // namespace

TEST_CASE(
    "every level has the mean depth, the mean slope and the second moment of slope of level 0, at any size") {
  for (const auto& s : tests::various_surfaces()) {
    const Means truth = means_of_texels(*s);
    for (int level = 1; level <= s->mips().coarsest(); ++level) {
      const Means means = means_of_level(s->mips(), level);
      CHECK(std::abs(means.depth - truth.depth) < 1e-5);
      CHECK((means.slope - truth.slope).norm() < 1e-4 * (1 + std::sqrt(truth.second)));
      CHECK(std::abs(means.second - truth.second) < 1e-3 * truth.second + 1e-9);
    }
  }
}

TEST_CASE("levels halve, rounding up, down to a single texel") {
  const auto s = tests::rough_surface(37, 53, surface::Edge::wrap);
  const Mips& mips = s->mips();
  REQUIRE(mips.coarsest() == 6);
  int width = 37, height = 53;
  for (int level = 1; level <= mips.coarsest(); ++level) {
    width = (width + 1) / 2;
    height = (height + 1) / 2;
    CHECK(mips.grid(level).width == width);
    CHECK(mips.grid(level).height == height);
  }
  CHECK((width == 1 && height == 1));
  CHECK(tests::rough_surface(1, 1, surface::Edge::clamp)->mips().coarsest() == 0);
}

TEST_CASE("a texel is the area-weighted mean of what it covers, at odd sizes too") {
  const auto s = tests::rough_surface(5, 4, surface::Edge::wrap, 1.0);
  // 5 texels to 3: the middle one covers 1/3 of texel 1, all of 2, 1/3 of 3... in units of 5/3 texels.
  const std::vector<float> depths = s->depth_texture();
  const auto d = [&](int i, int j) { return double(depths[s->grid().index(i, j)]); };
  const double low = (d(1, 0) / 3 + d(2, 0) + d(3, 0) / 3) / (5.0 / 3),
               high = (d(1, 1) / 3 + d(2, 1) + d(3, 1) / 3) / (5.0 / 3);
  CHECK(std::abs(s->mips().texel(1, 1, 0).depth - 0.5 * (low + high)) < 1e-5);
}

TEST_CASE("a footprint that blurs a ripple away turns its slope into roughness") {
  // Ridges of slope +-1, two texels wide: from the second level on nothing is left of them but their root
  // mean square slope, 1.
  const auto s = tests::made_surface(
      64, [](Vec2) { return 0.5; }, [](Vec2 uv) { return Vec3(int(uv.x() * 64) % 4 < 2 ? 1 : -1, 0, 1); });
  CHECK(s->sample({0.5, 0.5}, 0).roughness == 0);
  const Sample sample = s->sample({0.3, 0.6}, 8.0 / 64);
  CHECK(sample.roughness == doctest::Approx(1).epsilon(1e-3));
  CHECK((sample.normal - Vec3::UnitZ()).norm() < 1e-3);
}

TEST_CASE("the slope of a normal is limited, and a normal in the plane gives a number") {
  CHECK((slope_of(Vec3(-0.6, 0, 0.8)) - Vec2(0.75, 0)).norm() < 1e-12);
  CHECK(slope_of(Vec3(1, 0, 0)).norm() == doctest::Approx(max_slope));
  CHECK(slope_of(Vec3(0, 0, 1)).norm() == 0);
  CHECK(slope_of(Vec3(0, 0, 0)).norm() == 0);
}
