#include <doctest/doctest.h>

#include <cmath>

#include "core/portable_math.h"
#include "surface/ray.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::surface;

namespace {

// Brute force: every cell under the ray in order (Amanatides and Woo, 1987), and in each the height
// of the ray above the patch, a parabola in t, split at its turning point and bisected.
class March {
 public:
  March(const surface::Surface& surface, const Vec3& origin, const Vec3& direction)
      : s_(surface), o_(origin), d_(direction) {}

  std::optional<double> run(double t0, double t1) const {
    for (int axis = 0; axis < 2; ++axis) {
      const double size = axis == 0 ? s_.placement().size_u() : s_.placement().size_v();
      if (d_[axis] == 0 && (o_[axis] < 0 || o_[axis] > size)) return std::nullopt;
      if (d_[axis] == 0) continue;
      const double a = -o_[axis] / d_[axis], b = (size - o_[axis]) / d_[axis];
      t0 = std::max(t0, std::min(a, b));
      t1 = std::min(t1, std::max(a, b));
    }
    if (!(t0 <= t1)) return std::nullopt;
    auto [i, j] = s_.cell_at(o_.x() + t0 * d_.x(), o_.y() + t0 * d_.y());
    for (double t = t0; t <= t1;) {
      const Cell cell = s_.cell(i, j);
      const double t_x = d_.x() == 0 ? t1 + 1 : ((d_.x() > 0 ? cell.x1 : cell.x0) - o_.x()) / d_.x();
      const double t_y = d_.y() == 0 ? t1 + 1 : ((d_.y() > 0 ? cell.y1 : cell.y0) - o_.y()) / d_.y();
      const double leave = std::max(t, std::min({t_x, t_y, t1}));
      if (const auto hit = crossing(cell, t, leave)) return hit;
      if (leave >= t1) break;
      (t_x <= t_y ? i : j) += (t_x <= t_y ? d_.x() : d_.y()) > 0 ? 1 : -1;
      t = leave;
    }
    return std::nullopt;
  }

 private:
  double above(const Cell& cell, double t) const {
    const Vec3 p = o_ + t * d_;
    return p.z() - cell.at((p.x() - cell.x0) / cell.width(), (p.y() - cell.y0) / cell.height()).z();
  }
  std::optional<double> crossing(const Cell& cell, double a, double b) const {
    const double f0 = above(cell, a), f1 = above(cell, 0.5 * (a + b)), f2 = above(cell, b);
    const double curvature = 2 * (f0 - 2 * f1 + f2), slope = -3 * f0 + 4 * f1 - f2;
    const double turn = curvature != 0 ? std::clamp(-slope / (2 * curvature), 0.0, 1.0) : 1.0;
    const double middle = a + turn * (b - a);
    for (auto [low, high] : {std::pair{a, middle}, std::pair{middle, b}}) {
      const double at_low = above(cell, low);
      if (at_low == 0) return low;
      if (at_low * above(cell, high) > 0) continue;
      for (int round = 0; round < 60; ++round) {
        const double half = 0.5 * (low + high);
        (at_low * above(cell, half) > 0 ? low : high) = half;
      }
      return 0.5 * (low + high);
    }
    return std::nullopt;
  }

  const surface::Surface& s_;
  Vec3 o_, d_;
};

}  // namespace

TEST_CASE("a ray hits where a march through every cell finds it, whatever size, edge and direction") {
  const auto surfaces = tests::various_surfaces();
  const int count = tests::poses(5000) / int(surfaces.size()) + 1;
  double worst = 0;
  int hits = 0, grazed = 0;
  for (std::size_t n = 0; n < surfaces.size(); ++n) {
    const surface::Surface& s = *surfaces[n];
    Random random(200 + n);
    for (int k = 0; k < count; ++k) {
      const double flat = std::pow(10.0, random.uniform(-2, 0));
      const Vec3 target(random.uniform() * s.placement().size_u(), random.uniform() * s.placement().size_v(),
                        random.uniform(-s.max_depth(), 0));
      Vec3 direction(random.uniform(-1, 1), random.uniform(-1, 1), -flat);
      if (k % 10 == 0) direction[k / 10 % 2] = 0;  // along a row or a column
      if (k % 23 == 0) direction = Vec3(0, 0, -flat);
      const Vec3 origin = target - direction * random.uniform(0.02, 0.5) / flat;
      const auto hit = intersect(s, origin, direction, 0, 100);
      const auto brute = March(s, origin, direction).run(0, 100);
      // A ray that touches a crest within rounding may or may not be counted as a hit: the next one is then
      // far away.
      if (hit.has_value() != brute.has_value() ||
          (hit && std::abs(hit->t - *brute) * direction.norm() > 1e-6)) {
        ++grazed;
        continue;
      }
      if (!hit) continue;
      ++hits;
      worst = std::max(worst, std::abs(hit->t - *brute) * direction.norm());
      CHECK(std::abs(hit->point.z() + s.depth(s.placement().uv(hit->point))) < 1e-9);
      CHECK((origin + hit->t * direction - hit->point).norm() < 1e-9);
      CHECK(hit->normal.z() > 0);
    }
  }
  MESSAGE(hits << " hits, worst disagreement: " << worst << " m; grazes: " << grazed);
  CHECK(hits > count * int(surfaces.size()) / 2);
  CHECK(worst < 1e-6);
  CHECK(grazed == 0);
}

TEST_CASE("a ray hits nothing before its first hit") {
  const auto s = tests::brick_surface(64);
  Random random(21);
  int hits = 0;
  for (int k = 0; k < 3000; ++k) {
    const Vec3 target(random.uniform(), random.uniform(), random.uniform(-0.02, 0));
    const Vec3 origin =
        target + Vec3(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(0.02, 0.4));
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

TEST_CASE("straight down, the hit is the depth, up to the very border") {
  for (const auto& s : tests::various_surfaces()) {
    Random random(22);
    for (int k = 0; k < 300; ++k) {
      Vec2 uv(random.uniform(), random.uniform());
      if (k % 10 == 0) uv.x() = k % 20 == 0 ? 0 : 1;
      if (k % 10 == 5) uv.y() = std::floor(uv.y() * s->height()) / s->height();
      const Vec3 origin(uv.x() * s->placement().size_u(), uv.y() * s->placement().size_v(), 1);
      const auto hit = intersect(*s, origin, {0, 0, -1}, 0, 10);
      REQUIRE(hit);
      CHECK(hit->t - 1 == doctest::Approx(s->depth(uv)).epsilon(1e-9));
    }
  }
}

TEST_CASE("the length of the direction and the start along the ray do not matter") {
  const auto s = tests::brick_surface(64);
  Random random(23);
  int hits = 0;
  for (int k = 0; k < 1000; ++k) {
    const Vec3 target(random.uniform(), random.uniform(), -0.01),
        origin = target + Vec3(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), 0.2);
    const Vec3 direction = target - origin;
    const auto hit = intersect(*s, origin, direction, 0, 10);
    if (!hit) continue;  // it left the rectangle first
    ++hits;
    for (const double scale : {1e-9, 1e9, 1e-200, 1e200}) {
      const auto other = intersect(*s, origin, direction * scale, 0, std::numeric_limits<double>::infinity());
      REQUIRE(other);
      CHECK((other->point - hit->point).norm() < 1e-9);
    }
    const auto far = intersect(*s, origin - 1e4 * direction, direction, 0, 1e6);
    REQUIRE(far);
    CHECK((far->point - hit->point).norm() < 1e-6);
    CHECK_FALSE(intersect(*s, origin, direction, 0, hit->t * (1 - 1e-6)));
  }
  CHECK(hits > 900);
}

TEST_CASE("without a depth map a ray meets the plane z = 0") {
  Texels texels;
  texels.width = texels.height = 2;
  texels.normal.assign(4, Vec3::UnitZ());
  const surface::Surface s(std::move(texels), tests::flat_placement(), 0.02, surface::Edge::wrap);
  const auto hit = intersect(s, {0.2, 0.2, 1}, {0.1, 0.2, -1}, 0, 10);
  REQUIRE(hit);
  CHECK((hit->point - Vec3(0.3, 0.4, 0)).norm() < 1e-11);
  CHECK_FALSE(intersect(s, {0.2, 0.2, 1}, {1, 0, -1}, 0, 10));
}

TEST_CASE("rays beside the rectangle, away from it or with bad numbers hit nothing") {
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  for (const auto& s : tests::various_surfaces()) {
    CHECK_FALSE(intersect(*s, {1.5, 0.5, 1}, {0, 0, -1}, 0, 10));
    CHECK_FALSE(intersect(*s, {0.5, 0.5, 1}, {0, 0, 1}, 0, 10));
    CHECK_FALSE(intersect(*s, {0.5, 0.5, 1}, {0, 0, -1}, 0, 0.9));
    CHECK_FALSE(intersect(*s, {0.5, 0.5, 1}, {0, 0, -1}, 2, 1));
    CHECK_FALSE(intersect(*s, {0.5, 0.5, nan}, {0, 0, -1}, 0, 10));
    CHECK_FALSE(intersect(*s, {0.5, infinity, 1}, {0, 0, -1}, 0, 10));
    CHECK_FALSE(intersect(*s, {0.5, 0.5, 1}, {0, nan, -1}, 0, 10));
    CHECK_FALSE(intersect(*s, {0.5, 0.5, 1}, {0, 0, -infinity}, 0, 10));
    CHECK_FALSE(intersect(*s, {0.5, 0.5, 1}, {0, 0, -1}, nan, 10));
    CHECK_FALSE(intersect(*s, {0.5, 0.5, 1}, {0, 0, -1}, 0, nan));
    CHECK_FALSE(intersect(*s, {0.5, 0.5, 1}, {0, 0, 0}, 0, 10));
    CHECK_FALSE(intersect(*s, {1e6, 1e6, 1e6}, {1, 1, -1}, 0, 1e9));
    CHECK(intersect(*s, {-1e6 + 0.3, 0.3, 1e6}, {1, 0, -1}, 0, 1e9).has_value());
  }
}
