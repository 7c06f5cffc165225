#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/portable_math.h"
#include "surface/closest.h"
#include "surface/pyramid.h"
#include "surface/ray.h"
#include "surface/surface.h"
#include "tests/skipped.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::surface;

namespace {

// Calls visit(level, x, y) for every block.
template <class Visit>
void for_each_block(const Pyramid& p, const Visit& visit) {
  for (int level = 0; level < p.levels(); ++level) {
    for (int y = 0; p.exists(level, 0, y); ++y) {
      for (int x = 0; p.exists(level, x, y); ++x) visit(level, x, y);
    }
  }
}

// Brute force: the corners of every cell's part of the rectangle, in texels.
HeightRange brute_height_range(const surface::Surface& s, const Vec2& a, const Vec2& b) {
  const Vec2 low = a.cwiseMin(b), high = a.cwiseMax(b);
  HeightRange out{1, -1e9};
  const auto stops = [](double from, double to, int n) {
    std::vector<double> at = {from, to};
    for (double line = std::ceil(from * n - 0.5); line <= to * n - 0.5; ++line)
      at.push_back((line + 0.5) / n);
    return at;
  };
  for (const double v : stops(low.y(), high.y(), s.height())) {
    for (const double u : stops(low.x(), high.x(), s.width())) {
      const double z = -s.depth({u, v});
      out.low = std::min(out.low, z);
      out.high = std::max(out.high, z);
    }
  }
  return out;
}

}  // namespace

TEST_CASE(
    "bounds are conservative: no point of a block is outside its range or its slab, nor its slope outside the spread") {
  for (const auto& s : tests::various_surfaces()) {
    const Pyramid& p = s->pyramid();
    const double deepest = s->max_depth();
    CHECK(rc::check("conservative", [&] {
      const int level = *rc::gen::inRange(0, p.levels());
      const int side = Pyramid::block_cells(level);
      const int x = *rc::gen::inRange(0, (p.columns() + side - 1) / side),
                y = *rc::gen::inRange(0, (p.rows() + side - 1) / side);
      // A position in the block, in cells from its first.
      const double a = *rc::gen::inRange(0, 1001) / 1000.0 * std::min(side, p.columns() - x * side);
      const double b = *rc::gen::inRange(0, 1001) / 1000.0 * std::min(side, p.rows() - y * side);
      const Vec2 uv((p.first_cell() + x * side + a + 0.5) / s->width(),
                    (p.first_cell() + y * side + b + 0.5) / s->height());
      const double depth = s->depth(uv) / deepest;
      if (level > 0) {
        const Pyramid::Range range = p.range(level, x, y);
        RC_ASSERT(depth >= range.shallow - 1e-9);
        RC_ASSERT(depth <= range.deep + 1e-9);
      }
      const Pyramid::Bounds4 quad = p.quad(level, x / 2, y / 2);
      const auto k = std::size_t((x & 1) | (y & 1) << 1);
      RC_ASSERT(depth >= quad.shallow[k] - 1e-9);
      RC_ASSERT(depth <= quad.deep[k] + 1e-9);
      const Pyramid::Slab slab = p.slab(level, x, y);
      const double plane = slab.slope_x * (a - 0.5 * side) + slab.slope_y * (b - 0.5 * side);
      RC_ASSERT(depth >= slab.low + plane - 1e-9);
      RC_ASSERT(depth <= slab.high + plane + 1e-9);
      const Vec2 slope = s->gradient(uv).cwiseProduct(Vec2(s->texel_u(), s->texel_v())) / -deepest;
      RC_ASSERT(std::abs(slope.x() - slab.slope_x) <= slab.spread_x + 1e-6);
      RC_ASSERT(std::abs(slope.y() - slab.slope_y) <= slab.spread_y + 1e-6);
    }));
  }
}

TEST_CASE("ranges are exact: some texel is as deep as they say, some as shallow") {
  for (const auto& s : tests::various_surfaces()) {
    const Pyramid& p = s->pyramid();
    const std::vector<float> depths = s->depth_texture();
    for_each_block(p, [&](int level, int x, int y) {
      if (level == 0) return;
      const int side = Pyramid::block_cells(level);
      double shallow = 2, deep = -1;
      for (int j = y * side; j <= std::min((y + 1) * side, p.rows()); ++j) {
        for (int i = x * side; i <= std::min((x + 1) * side, p.columns()); ++i) {
          const double depth = depths[s->grid().index(p.first_cell() + i, p.first_cell() + j)];
          shallow = std::min(shallow, depth);
          deep = std::max(deep, depth);
        }
      }
      CHECK(p.range(level, x, y).shallow == shallow);
      CHECK(p.range(level, x, y).deep == deep);
    });
    CHECK(p.total_range().shallow == *std::min_element(depths.begin(), depths.end()));
    CHECK(p.total_range().deep == *std::max_element(depths.begin(), depths.end()));
  }
}

TEST_CASE("slabs are tight on a slope: a tilted plane is bounded within a few steps of storage") {
  const auto s = tests::made_surface(
      64, [](Vec2 uv) { return 0.2 + 0.5 * uv.x() + 0.2 * uv.y(); }, [](Vec2) { return Vec3::UnitZ(); }, 0.02,
      tests::flat_placement(), surface::Edge::clamp);
  for_each_block(s->pyramid(), [&](int level, int x, int y) {
    if (level > 0 || x == 0 || y == 0 || x > 14 || y > 14) return;  // at the border it is not a plane
    const Pyramid::Slab slab = s->pyramid().slab(level, x, y);
    CHECK(slab.high - slab.low < 5e-4);
    CHECK(slab.slope_x == doctest::Approx(0.5 / 64).epsilon(0.01));
  });
}

TEST_CASE("lowest and highest over a rectangle are those of brute force") {
  const auto surfaces = tests::various_surfaces();
  const int count = tests::poses(2000) / int(surfaces.size()) + 1;
  double worst = 0;
  for (const auto& s : surfaces) {
    Random random(40);
    for (int k = 0; k < count; ++k) {
      const Vec2 a(random.uniform(-1, 2), random.uniform(-1, 2));
      const double size = std::pow(10.0, random.uniform(-3, 0.3));
      const Vec2 b = a + Vec2(random.uniform(-size, size), random.uniform(-size, size));
      const HeightRange found = height_range(*s, a, b), brute = brute_height_range(*s, a, b);
      worst = std::max({worst, std::abs(found.low - brute.low), std::abs(found.high - brute.high)});
    }
  }
  MESSAGE("worst disagreement: " << worst << " m");
  CHECK(worst < 1e-12);
}

TEST_CASE("the height range of a point is its height, of everything the total range, of a plane zero") {
  for (const auto& s : tests::various_surfaces()) {
    const Vec2 uv(0.37, 0.61);
    CHECK(height_range(*s, uv, uv).low == doctest::Approx(-s->depth(uv)).epsilon(1e-12));
    const HeightRange all = height_range(*s, {-3, -3}, {3, 3}),
                      nothing = height_range(*s, {std::nan(""), 0}, {1, 1}),
                      far = height_range(*s, {-1e300, -1e300}, {1e300, 1e300});
    const Pyramid::Range whole = s->pyramid().total_range();
    for (const HeightRange& e : {all, nothing, far}) {
      CHECK(e.low == doctest::Approx(-s->max_depth() * whole.deep));
      CHECK(e.high == doctest::Approx(-s->max_depth() * whole.shallow));
    }
    const HeightRange aside = height_range(*s, {1e300, 0.5}, {1e300, 0.5});
    CHECK((aside.low <= aside.high && aside.high <= 0 && aside.low >= -s->max_depth()));
  }
  Texels texels;
  texels.width = texels.height = 2;
  texels.normal.assign(4, Vec3::UnitZ());
  const surface::Surface flat(std::move(texels), tests::flat_placement(), 0.02, surface::Edge::wrap);
  CHECK(height_range(flat, {0, 0}, {1, 1}).low == 0);
  CHECK(flat.pyramid().levels() == 0);
}

TEST_CASE("a texture of 8192 x 8192 loads and answers") {
  if (std::getenv("INTAGLIO_SLOW") == nullptr) {
    tests::skipped("INTAGLIO_SLOW is not set");
    return;
  }
  const auto s = tests::rough_surface(8192, 8192, surface::Edge::wrap, 0.05);
  MESSAGE("8192 x 8192 surface: " << s->memory_bytes() / 1048576 << " MiB");
  Random random(41);
  for (int k = 0; k < 1000; ++k) {
    const Vec3 p(random.uniform(), 0.7 * random.uniform(), random.uniform(0, 0.05));
    const auto feature = closest_point(*s, p);
    REQUIRE(feature);
    CHECK(std::abs(feature->distance) <= p.z() + s->depth(s->placement().uv(p)) + 1e-12);
    const auto hit = intersect(*s, p + Vec3(0, 0, 1), {0, 0, -1}, 0, 10);
    REQUIRE(hit);
    CHECK(std::abs(hit->point.z() + s->depth(s->placement().uv(p))) < 1e-9);
  }
}
