// The closest features of a relief on a curved base, against dense samples of the field, each improved by
// trial and error; uses only MeshPlacement and Surface::depth.
#include <algorithm>
#include <cmath>

#include "core/portable_math.h"
#include "mesh/relief_closest.h"
#include "tests/count_allocations.h"
#include "tests/mesh/curved_bases.h"

using namespace intaglio;
using namespace intaglio::surface;

namespace {

struct Sampled {
  Vec3 point;
  int triangle;
  Vec3 weights;
};

std::vector<Sampled> samples(const ReliefMesh& relief, int in_all) {
  std::vector<Sampled> out;
  const int count = int(relief.base().mesh().triangles.size());
  const int fine = std::max(2, int(std::sqrt(2.0 * in_all / count)));
  for (int k = 0; k < count; ++k) {
    for (int i = 0; i <= fine; ++i) {
      for (int j = 0; i + j <= fine; ++j) {
        const Vec3 weights(1 - double(i + j) / fine, double(i) / fine, double(j) / fine);
        out.push_back({relief.point(k, weights), k, weights});
      }
    }
  }
  return out;
}

// The least of `value` near a sample, in its triangle: ever smaller steps to where it is less.
template <class Value>
double improved(const ReliefMesh& relief, const Sampled& from, double step, const Value& value) {
  Vec3 at = from.weights;
  double best = value(relief.point(from.triangle, at));
  for (; step > 1e-10; step *= 0.5) {
    for (bool again = true; again;) {
      again = false;
      for (int k = 0; k < 8; ++k) {
        const double angle = k * std::numbers::pi / 4;
        const double a = std::clamp(at[1] + step * std::cos(angle), 0.0, 1.0),
                     b = std::clamp(at[2] + step * std::sin(angle), 0.0, 1 - a);
        const Vec3 there(1 - a - b, a, b);
        const double next = value(relief.point(from.triangle, there));
        if (next >= best) continue;
        best = next;
        at = there;
        again = true;
      }
    }
  }
  return best;
}

// The least of `value` that sampling finds.
template <class Value>
double sampled(const ReliefMesh& relief, const std::vector<Sampled>& all, const Value& value) {
  std::vector<std::pair<double, const Sampled*>> by_value;
  for (const Sampled& s : all) by_value.emplace_back(value(s.point), &s);
  const std::size_t some = std::min<std::size_t>(8, by_value.size());
  std::partial_sort(by_value.begin(), by_value.begin() + std::ptrdiff_t(some), by_value.end());
  double best = by_value[0].first;
  for (std::size_t k = 0; k < some; ++k)
    best = std::min(best, improved(relief, *by_value[k].second, 0.02, value));
  return best;
}

// A feature is a point of the field.
void check_on_field(const ReliefMesh& relief, const MeshFeature& f) {
  const Vec3 weights(1 - f.weights[0] - f.weights[1], f.weights[0], f.weights[1]);
  CHECK(weights.minCoeff() >= -1e-12);
  CHECK((relief.point(f.triangle, weights) - f.point).norm() < 1e-12);
}

}  // namespace

TEST_CASE("no sample of the field is nearer than the closest point of a relief on a curved base") {
  for (const auto& [name, relief, radius, is_torn] : tests::various_reliefs()) {
    const auto all = samples(relief, 30000);
    Random random(61);
    double worst = -1;
    const int count = tests::poses(30, 2000);
    for (int k = 0; k < count; ++k) {
      const Vec3 p = tests::near_relief(random, relief, -0.5 * radius, 3 * radius);
      const auto ours = closest_point(relief, p, 10);
      REQUIRE(ours);
      check_on_field(relief, *ours);
      CHECK(std::abs((ours->point - p).norm() - std::abs(ours->distance)) < 1e-12);
      const double theirs = sampled(relief, all, [&](const Vec3& x) { return (x - p).norm(); });
      worst = std::max(worst, std::abs(ours->distance) - theirs);
    }
    MESSAGE(name << ": of " << count << " poses none has a sample nearer by more than " << worst << " m");
    CHECK(worst < 1e-9);
  }
}

TEST_CASE("no sample is nearer than the nearest to a segment, nor lower than the lowest along a direction") {
  for (const auto& [name, relief, radius, is_torn] : tests::various_reliefs()) {
    const auto all = samples(relief, 30000);
    Random random(62);
    double worst = -1, worst_through = -1, worst_lowest = -1;
    const int count = tests::poses(15, 1000);
    for (int k = 0; k < count; ++k) {
      const Vec3 from = tests::near_relief(random, relief, 0.2 * radius, radius),
                 to = from + tests::any_vector(random, radius);
      const auto ours = closest_to_segment(relief, from, to, 10);
      REQUIRE(ours);
      check_on_field(relief, *ours);
      const Vec3 along = to - from;
      const auto distance = [&](const Vec3& x) {
        const double s = std::clamp(along.dot(x - from) / along.squaredNorm(), 0.0, 1.0);
        return (x - from - s * along).norm();
      };
      const double theirs = sampled(relief, all, distance), excess = std::abs(ours->distance) - theirs;
      // Where the segment crosses the relief, every crossing is nearest, and the search stops near enough.
      (theirs > 1e-4 ? worst : worst_through) = std::max(theirs > 1e-4 ? worst : worst_through, excess);

      const Vec3 down = tests::any_vector(random, 1).normalized();
      const auto lowest = lowest_point(relief, down, 0, 10);
      REQUIRE(lowest);
      check_on_field(relief, *lowest);
      worst_lowest = std::max(
          worst_lowest, lowest->distance - sampled(relief, all, [&](const Vec3& x) { return down.dot(x); }));
    }
    MESSAGE(name << ": no sample nearer to a segment by more than " << worst << " m (" << worst_through
                 << " where it goes through), none lower by more than " << worst_lowest);
    // Over flat facets a segment's function is a valley with a kink, whose end Newton's method may miss.
    CHECK(worst < (relief.surface().is_flat() ? 5e-5 : 1e-9));
    CHECK(worst_through < 1e-4);
    CHECK(worst_lowest < 1e-9);
  }
}

TEST_CASE("the side of a closest point is right above and below the relief along the base's normal") {
  for (const auto& [name, relief, radius, is_torn] : tests::various_reliefs()) {
    if (is_torn) continue;  // where it is, nothing is on either side of the gap
    Random random(63);
    for (int k = 0; k < tests::poses(200, 5000); ++k) {
      const int triangle = tests::any_triangle(random, relief.base());
      const Vec3 weights = tests::any_weights(random);
      const Vec3 n = relief.base().at(triangle, weights).n, on = relief.point(triangle, weights);
      // Beside a border nothing is below.
      if (std::abs(on.x() - 0.5) > 0.4 || std::abs(on.z() + 0.5) > 0.4) continue;
      const double h = random.uniform(0.01, 0.2) * radius;
      const auto above = closest_point(relief, on + h * n, 1), below = closest_point(relief, on - h * n, 1);
      REQUIRE(above);
      REQUIRE(below);
      CHECK(above->distance > 0);
      CHECK((above->direction - (on + h * n - above->point).normalized()).norm() < 1e-6);
      CHECK(below->distance < 0);
    }
  }
}

TEST_CASE("features are local minima with distinct directions, nearest first, and nothing allocates") {
  // A base without a seam: at a tear this does not hold.
  const auto relief =
      tests::relief_on(tests::wavy(11), tests::rough_surface(24, 24, Edge::clamp, 0.4, 3, 0.04));
  Random random(64);
  int several = 0;
  for (int k = 0; k < tests::poses(150, 3000); ++k) {
    const Vec3 p = tests::near_relief(random, relief, 0.02, 0.25);
    std::array<MeshFeature, 6> found;
    const std::size_t before = allocations();
    const std::size_t count = closest_features(relief, p, 0.25, 0.35, found);
    CHECK(allocations() == before);
    several += count > 1 ? 1 : 0;
    for (std::size_t n = 0; n < count; ++n) {
      const MeshFeature& f = found[n];
      check_on_field(relief, f);
      CHECK(f.distance <= 0.25);
      if (n > 0) CHECK(f.distance >= found[n - 1].distance - 1e-12);
      for (std::size_t m = 0; m < n; ++m) CHECK(f.direction.dot(found[m].direction) <= std::cos(0.35) + 1e-9);
    }
    // Around each, the field is not nearer.
    for (std::size_t n = 0; n < count; ++n) {
      const MeshFeature& f = found[n];
      for (int m = 0; m < 20; ++m) {
        const Vec2 w = f.weights + 1e-5 * Vec2(random.normal(), random.normal());
        if (w.minCoeff() < 0 || w.sum() > 1) continue;
        CHECK((relief.point(f.triangle, {1 - w.sum(), w[0], w[1]}) - p).norm() >= f.distance - 1e-12);
      }
    }
  }
  MESSAGE(several << " had several");
  CHECK(several > 20);
}

TEST_CASE("a base that folds is refused with the place; invalid queries of a relief have no answer") {
  auto base = MeshPlacement::make(make_cylinder(0.01, 1, 32, 1), "pin.obj");
  REQUIRE(base);
  const auto folded = ReliefMesh::make(tests::brick_surface(32), *base);
  REQUIRE(!folded);
  CHECK(folded.error().message().find("folds") != std::string::npos);
  CHECK(!ReliefMesh::make(nullptr, *base));
  const auto relief = tests::relief_on(make_sphere(0.5, 12, 6), tests::brick_surface(32));
  const double nan = std::nan("");
  CHECK(!closest_point(relief, {nan, 0, 0}, 1));
  CHECK(!closest_point(relief, {0, 0, 0}, nan));
  CHECK(!closest_point(relief, {0, 0, 0}, 0));
  CHECK(!closest_point(relief, {1e6, 0, 0}, 1));
  CHECK(closest_point(relief, {0, 0, 0}, 1)->distance < 0);
  CHECK(!closest_to_segment(relief, {0, nan, 0}, {0, 0, 0}, 1));
  CHECK(!lowest_point(relief, {0, nan, 0}, 0, 1));
}
