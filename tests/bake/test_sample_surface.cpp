#include <doctest/doctest.h>

#include <cmath>
#include <map>

#include "core/portable_math.h"
#include "sound/bake/fem/tet_mesh.h"
#include "sound/bake/sample_surface.h"
#include "tests/sound/models.h"

using namespace intaglio;
using namespace intaglio::sound;

TEST_CASE("a sampled model is smaller, closed, and rings under a blow as the full one does" *
          doctest::test_suite("statistics")) {
  // Elements far smaller than the waves, as a thin body needs.
  const TetMesh mesh = box({0.3, 0.01, 0.3}, 20, 1, 20);
  const ModeOptions modes{20, 20, 20'000};
  const auto whole = bake(mesh, *find_material("ceramic"), {"tile", modes, {0}});
  const auto sampled = bake(mesh, *find_material("ceramic"), {"tile", modes});
  REQUIRE(whole);
  REQUIRE(sampled);
  MESSAGE(whole->points.size() << " points become " << sampled->points.size() << ", shape error "
                               << 100 * sampled->shape_error << " %");
  CHECK(sampled->points.size() < 0.2 * double(whole->points.size()));
  CHECK(sampled->angular_frequency == whole->angular_frequency);
  CHECK(sampled->area == whole->area);
  double louder = 0;  // radiation of each mode's coherent group, in dB
  const Eigen::VectorXd of_sampled = test::radiated_power(*sampled, sampled->radiation),
                        of_whole = test::radiated_power(*whole, whole->radiation);
  for (Eigen::Index m = 0; m < 20; ++m)
    louder = std::max(louder, std::abs(10 * std::log10(of_sampled[m] / of_whole[m])));
  MESSAGE("radiation is " << louder << " dB off at most");
  CHECK(louder < 1.5);
  CHECK(whole->shape_error == 0);
  CHECK(sampled->shape_error > 0);
  CHECK(sampled->shape_error < 0.08);

  std::map<std::pair<int, int>, int> edges;
  for (const Triangle& t : sampled->triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  }
  for (const auto& [edge, uses] : edges) {
    CHECK(uses == 1);
    CHECK(edges.contains({edge.second, edge.first}));
  }
  Random random(7);
  std::vector<float> a(20), b(20);
  std::vector<double> error(20, 0), size(20, 0), largest(20, 0), worst(20, 0);
  for (int k = 0; k < 1000; ++k) {
    const Vec3 p(random.uniform(-0.15, 0.15), 0.005, random.uniform(-0.15, 0.15));
    whole->gains(p, Vec3::UnitY(), a);
    sampled->gains(p, Vec3::UnitY(), b);
    for (std::size_t m = 0; m < 20; ++m) {
      const double e = std::abs(double(a[m]) - double(b[m]));
      error[m] += e * e;
      size[m] += double(a[m]) * double(a[m]);
      largest[m] = std::max(largest[m], std::abs(double(a[m])));
      worst[m] = std::max(worst[m], e);
    }
  }
  for (std::size_t m = 0; m < 20; ++m) {
    if (size[m] < 1) continue;  // an in-plane mode is not struck out of the plane
    CHECK(std::sqrt(error[m] / size[m]) < 0.08);
    // Between the points that are kept; which of a degenerate pair is which, and so the points, is the
    // compiler's.
    CHECK(worst[m] < 0.15 * largest[m]);
  }
}

TEST_CASE("no point is removed where every point matters") {
  const auto model = bake(box({0.1, 0.1, 0.1}, 2, 2, 2), test::steel(), {"cube", {10, 20, 60'000}, {1e-6}});
  REQUIRE(model);
  CHECK(model->points.size() == 98);
  CHECK(model->shape_error < 1e-6);
}
