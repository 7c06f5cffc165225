#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "core/portable_math.h"
#include "tests/count_allocations.h"
#include "tests/sound/models.h"

using namespace intaglio;
using namespace intaglio::sound;
using test::tau;

namespace {

double distance_to(const Vec3& p, const ModalModel& model, const Triangle& t, const Vec3& weights) {
  Vec3 at = Vec3::Zero();
  for (std::size_t i = 0; i < 3; ++i) at += weights[Eigen::Index(i)] * model.points[std::size_t(t[i])];
  return (at - p).norm();
}

// By a search of all triangles.
double nearest_distance(const Vec3& p, const ModalModel& model) {
  double least = std::numeric_limits<double>::infinity();
  for (const Triangle& t : model.triangles) {
    const Vec3 w = nearest_barycentric(p, model.points[std::size_t(t[0])], model.points[std::size_t(t[1])],
                                       model.points[std::size_t(t[2])]);
    least = std::min(least, distance_to(p, model, t, w));
  }
  return least;
}

}  // namespace

TEST_CASE("a baked model has the mass and area of its shape, and Rayleigh damping") {
  const auto model = test::small_slab();
  CHECK(model->mass == doctest::Approx(2400 * 0.5 * 0.5 * 0.03));
  CHECK(model->area == doctest::Approx(2 * 0.25 + 4 * 0.5 * 0.03));
  REQUIRE(model->modes() == 40);
  for (std::size_t m = 0; m < 40; ++m) {
    const double omega = model->angular_frequency[m];
    CHECK(model->damping[m] == doctest::Approx(0.5 * (10 + 8e-7 * omega * omega)));
    CHECK(model->radiation[m] != 0);
  }
}

TEST_CASE("overdamped modes are dropped") {
  Material mud = *find_material("plastic");
  mud.rayleigh_beta = 1e-3;  // d = omega at omega = 2000
  const auto model = bake(box({1, 0.1, 1}, 4, 1, 4), mud, {"mud", {40, 20, 20'000}});
  REQUIRE(model);
  CHECK(model->modes() > 0);
  CHECK(model->modes() < 40);
  for (int m = 0; m < model->modes(); ++m)
    CHECK(model->damping[std::size_t(m)] < model->angular_frequency[std::size_t(m)]);
}

TEST_CASE("the grid finds the nearest triangle, as a search of all of them does") {
  for (const auto& model : {test::small_ball(), test::small_slab()}) {
    Random random(3);
    Vec3 low = model->points[0], high = low;
    for (const Vec3& p : model->points) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    for (int trial = 0; trial < 300; ++trial) {
      // Near the surface, where contacts are: a random point of it, moved by a little.
      const Triangle& t = model->triangles[std::size_t(random.next() % model->triangles.size())];
      Vec3 p = Vec3::Zero();
      for (const int corner : t) p += model->points[std::size_t(corner)] / 3;
      p += 0.005 * (high - low).maxCoeff() *
           Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      p = p.cwiseMax(low).cwiseMin(high);
      const TrianglePoint at = model->grid.nearest(p, model->points, model->triangles);
      CHECK(at.barycentric.sum() == doctest::Approx(1));
      CHECK(at.barycentric.minCoeff() >= 0);
      const double distance =
          distance_to(p, *model, model->triangles[std::size_t(at.triangle)], at.barycentric);
      CHECK(distance == doctest::Approx(nearest_distance(p, *model)));
    }
  }
}

TEST_CASE("triangles without area are found as any others, and far points nobody names do no harm") {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1e6, -1e6, 1e6}, {0, 1e-9, 0}};
  const std::vector<std::vector<Triangle>> lists{{{0, 1, 2}}, {{0, 0, 0}}, {{0, 0, 1}, {1, 1, 1}},
                                                 {{0, 1, 0}}, {{1, 0, 0}}, {{0, 1, 4}, {2, 2, 0}}};
  for (const auto& triangles : lists) {
    const TriangleGrid grid(points, triangles);
    for (const Vec3& p : {Vec3(0.5, 0.1, 0), Vec3(-5, 0, 0), Vec3(1e6, 0, 0), Vec3(0, 0, 0)}) {
      const TrianglePoint found = grid.nearest(p, points, triangles);
      CHECK(found.triangle >= 0);
      CHECK(found.triangle < int(triangles.size()));
      CHECK(found.barycentric.allFinite());
      CHECK(found.barycentric.sum() == doctest::Approx(1));
    }
  }
}

TEST_CASE("gains are linear in the direction, exact at the points, and never fail far away") {
  const auto model = test::small_slab();
  const auto n = std::size_t(model->modes());
  std::vector<float> x(n), y(n), both(n);
  const Vec3 p(0.1, 0.015, -0.07), a(0.3, 1, 0), b(0, -2, 0.5);
  model->gains(p, a, x);
  model->gains(p, b, y);
  model->gains(p, a + 2 * b, both);
  for (std::size_t m = 0; m < n; ++m) CHECK(both[m] == doctest::Approx(x[m] + 2 * y[m]).epsilon(1e-4));
  for (int point = 0; point < 20; ++point) {
    model->gains(model->points[std::size_t(point)], Vec3::UnitY(), x);
    for (std::size_t m = 0; m < n; ++m)
      CHECK(x[m] == doctest::Approx(model->shape(point, int(m)).y()).epsilon(1e-4));
  }
  for (const Vec3& far : {Vec3(1e9, -1e9, 0), Vec3(0, 0, 0), Vec3(0, 1e300, 0)}) {
    model->gains(far, Vec3::UnitY(), x);
    for (const float gain : x) CHECK(std::isfinite(gain));
  }
  const std::size_t before = allocations();
  model->gains(p, a, x);
  CHECK(allocations() == before);
}

TEST_CASE("invalid input is rejected with a reason") {
  const TetMesh mesh = box({1, 1, 1}, 1, 1, 1);
  Material material = test::steel();
  material.poisson_ratio = 0.5;
  CHECK_FALSE(bake(mesh, material));
  material = test::steel();
  material.density = 0;
  CHECK_FALSE(bake(mesh, material));
  material = test::steel();
  material.youngs_modulus = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(bake(mesh, material));
  TetMesh inverted = mesh;
  for (Vec3& node : inverted.nodes) node.x() = -node.x();
  const auto refused = bake(inverted, test::steel());
  REQUIRE_FALSE(refused);
  CHECK(refused.error().message().find("inverted") != std::string::npos);
  CHECK_FALSE(bake(TetMesh{}, test::steel()));
}
