#include <doctest/doctest.h>

#include <limits>
#include <numbers>
#include <thread>

#include "core/portable_math.h"
#include "mesh/base_patch.h"
#include "tests/mesh/mesh_shapes.h"

using namespace intaglio;
using namespace intaglio::surface;
using namespace intaglio::tests;

namespace {

double difference(const BasePoint& a, const BasePoint& b) {
  return std::max({(a.uv - b.uv).norm(), std::abs(a.height - b.height), (a.point - b.point).norm(),
                   (a.t - b.t).norm(), (a.b - b.b).norm(), (a.n - b.n).norm()});
}

// The heights above one triangle by an independent method: Newton's in (w1, w2, s) from several starts.
double height_by_newton(const BasePatch& patch, const Vec3& point) {
  double best = std::numeric_limits<double>::infinity();
  for (const double start : {0.0, -0.05, 0.05}) {
    Vec3 x(1.0 / 3, 1.0 / 3, start);
    double residual = 1;
    for (int iteration = 0; iteration < 40; ++iteration) {
      const Vec3 w(1 - x[0] - x[1], x[0], x[1]);
      const Vec3 n = w[0] * patch.n[0] + w[1] * patch.n[1] + w[2] * patch.n[2];
      const Vec3 miss = patch.position(w) + x[2] * n - point;
      Mat3 jacobian;
      jacobian << patch.p[1] - patch.p[0] + x[2] * (patch.n[1] - patch.n[0]),
          patch.p[2] - patch.p[0] + x[2] * (patch.n[2] - patch.n[0]), n;
      x -= jacobian.inverse() * miss;
      residual = miss.norm();
      if (jacobian.determinant() <= 0) residual = 1;  // beyond a fold
    }
    const Vec3 w(1 - x[0] - x[1], x[0], x[1]);
    if (!(residual < 1e-12) || w.minCoeff() < 0) continue;
    const double height = x[2] * (w[0] * patch.n[0] + w[1] * patch.n[1] + w[2] * patch.n[2]).norm();
    if (std::abs(height) < std::abs(best)) best = height;
  }
  return best;
}

BasePatch patch_of(const TriangleMesh& mesh, std::size_t k) {
  BasePatch patch;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const auto index = std::size_t(mesh.triangles[k][corner]);
    patch.p[corner] = mesh.positions[index];
    patch.n[corner] = mesh.normals[index];
  }
  return patch;
}

}  // namespace

TEST_CASE("on a flat quad the mesh placement is the rectangle's") {
  Random random(1);
  double worst = 0;
  for (int k = 0; k < 2000; ++k) {
    const Placement flat(any_vector(random, 3), any_rotation(random), random.uniform(0.1, 2),
                         random.uniform(0.1, 2));
    const auto mesh = MeshPlacement::make(make_quad(flat));
    REQUIRE(mesh);
    const Vec3 local(random.uniform(-0.2, 1.2) * flat.size_u(), random.uniform(-0.2, 1.2) * flat.size_v(),
                     random.uniform(-0.4, 0.4));
    const auto at = mesh->closest(flat.to_world(local), 0.5);
    REQUIRE(at.has_value() == flat.covers(local));
    if (!at) continue;
    const BasePoint expected{flat.uv(local),
                             local.z(),
                             flat.to_world({local.x(), local.y(), 0}),
                             flat.t(),
                             flat.b(),
                             flat.n(),
                             0,
                             {}};
    worst = std::max(worst, difference(*at, expected));
    CHECK((mesh->to_world(at->uv, at->height).value() - flat.to_world(local)).norm() < 1e-12);
    Eigen::Matrix2d sides;
    sides << flat.size_u(), 0, 0, flat.size_v();
    CHECK((mesh->stretch(*at) - sides).norm() < 1e-12);
  }
  MESSAGE("worst difference from the rectangle: " << worst);
  CHECK(worst < 1e-12);
}

TEST_CASE("moving the mesh and the point together leaves the answer unchanged") {
  Random random(2);
  const auto still = MeshPlacement::make(wavy(24));
  REQUIRE(still);
  double worst = 0;
  int answered = 0;
  for (int k = 0; k < 40; ++k) {
    const Pose pose{any_vector(random, 10), any_rotation(random)};
    const auto turned = MeshPlacement::make(moved(still->mesh(), pose));
    REQUIRE(turned);
    CHECK(turned->fold_depth() == doctest::Approx(still->fold_depth()).epsilon(1e-9));
    for (int m = 0; m < 100; ++m) {
      const Vec3 p(random.uniform(-0.1, 1.1), random.uniform(-0.1, 0.15), random.uniform(-1.1, 0.1));
      const auto here = still->closest(p, 0.1);
      const auto there = turned->closest(pose.to_world(p), 0.1);
      REQUIRE(here.has_value() == there.has_value());
      if (!here) continue;
      ++answered;
      const BasePoint back{there->uv,
                           there->height,
                           pose.to_local(there->point),
                           pose.orientation.conjugate() * there->t,
                           pose.orientation.conjugate() * there->b,
                           pose.orientation.conjugate() * there->n,
                           0,
                           {}};
      worst = std::max(worst, difference(*here, back));
    }
  }
  MESSAGE("worst difference after a motion: " << worst << " of " << answered);
  CHECK(answered > 1000);
  CHECK(worst < 1e-11);
}

TEST_CASE("world -> (u, v, height) -> world round-trips on curved shapes") {
  struct Shape {
    std::string name;
    TriangleMesh mesh;
    double low, high;  // heights
  };
  const std::vector<Shape> shapes = {{"sphere", make_sphere(0.5, 48, 24), -0.45, 1},
                                     {"cylinder", make_cylinder(0.5, 1, 48, 6), -0.45, 1},
                                     {"bowl", make_bowl(0.5, 48, 16), -0.5, 0.4}};
  Random random(3);
  for (const Shape& shape : shapes) {
    CAPTURE(shape.name);
    const auto placement = MeshPlacement::make(shape.mesh, shape.name);
    REQUIRE(placement);
    double worst = 0;
    for (int k = 0; k < 3000; ++k) {
      const BasePoint given = placement->at(any_triangle(random, *placement), any_weights(random),
                                            random.uniform(shape.low, shape.high));
      const auto found = placement->closest(given.world(), 2);
      REQUIRE(found);
      worst = std::max(worst, difference(given, *found));
      // Also through the texture coordinate alone, as a renderer or a sound does.
      const auto again = placement->to_world(found->uv, found->height);
      REQUIRE(again);
      worst = std::max(worst, (*again - given.world()).norm());
      CHECK((placement->to_world(found->triangle, found->weights, found->height) - found->world()).norm() ==
            0);
    }
    MESSAGE(shape.name << ": worst round trip " << worst);
    CHECK(worst < 1e-9);
  }
}

TEST_CASE("the nearest base point of all triangles is found" * doctest::test_suite("statistics")) {
  const auto placement = MeshPlacement::make(wavy(12));
  REQUIRE(placement);
  Random random(4);
  int found = 0, missed = 0;
  for (int k = 0; k < 500; ++k) {
    const Vec3 p(random.uniform(-0.1, 1.1), random.uniform(-0.2, 0.2), random.uniform(-1.1, 0.1));
    const double reach = 0.12;
    double brute = std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t < placement->mesh().triangles.size(); ++t) {
      const double height = height_by_newton(patch_of(placement->mesh(), t), p);
      if (std::abs(height) < std::abs(brute)) brute = height;
    }
    const auto at = placement->closest(p, reach);
    CAPTURE(p.transpose());
    CHECK(at.has_value() == (std::abs(brute) <= reach));
    ++(at ? found : missed);
    if (!at) continue;
    CHECK(at->height == doctest::Approx(brute).epsilon(1e-9));
    CHECK((at->world() - p).norm() < 1e-12);
    CHECK(std::abs((p - at->point).norm() - std::abs(at->height)) < 1e-12);
  }
  CHECK(found > 100);
  CHECK(missed > 50);
}

TEST_CASE("no height is less than the distance to the flat triangle, and bounds never rule out an answer") {
  Random random(9);
  int answered = 0, ruled_out = 0;
  for (int k = 0; k < 3000; ++k) {
    BasePatch patch;
    for (Vec3& corner : patch.p) corner = any_vector(random, 1);
    const Vec3 up = (patch.p[1] - patch.p[0]).cross(patch.p[2] - patch.p[0]).normalized();
    for (Vec3& normal : patch.n) normal = (up + any_vector(random, 0.4)).normalized();
    // Half of the points anywhere, half on a normal line.
    const Vec3 w = any_weights(random);
    const Vec3 point = k % 2 == 0 ? any_vector(random, 1.5)
                                  : Vec3(patch.position(w) + random.uniform(-0.9, 0.9) * patch.normal(w));
    const double distance = triangle_distance(patch, point);
    double sampled = std::numeric_limits<double>::infinity();
    for (int a = 0; a <= 60; ++a) {
      for (int b = 0; a + b <= 60; ++b)
        sampled = std::min(sampled, (patch.position(Vec3(60 - a - b, a, b) / 60) - point).norm());
    }
    CHECK(distance <= sampled * (1 + 1e-12));
    CHECK(distance >= sampled - 0.06);
    const auto projection = project(patch, point, 0.8);
    const bool may = PatchBounds(patch).may_reach(point, 0.8);
    if (!may) ++ruled_out;
    if (!projection) continue;
    ++answered;
    CHECK(may);
    CHECK(std::abs(projection->height) >= distance - 1e-9);
    const Vec3 back =
        patch.position(projection->weights) + projection->height * patch.normal(projection->weights);
    CHECK((back - point).norm() < 1e-9);
  }
  CHECK(answered > 1000);
  CHECK(ruled_out > 100);
}

TEST_CASE("a texture coordinate is found in the triangle that contains it") {
  const auto placement = MeshPlacement::make(wavy(17));
  REQUIRE(placement);
  Random random(5);
  for (int k = 0; k < 2000; ++k) {
    const BasePoint given = placement->at(any_triangle(random, *placement), any_weights(random), 0.01);
    const auto found = placement->at(given.uv, 0.01);
    REQUIRE(found);
    CHECK(difference(given, *found) < 1e-9);
    CHECK_FALSE(placement->at(given.uv + Vec2(1.01, 0)));
  }
  CHECK_FALSE(placement->at(Vec2(std::nan(""), 0)));
}

TEST_CASE("stretch is how the base moves with u and v") {
  const double radius = 0.5;
  const auto placement = MeshPlacement::make(make_sphere(radius, 200, 100));
  REQUIRE(placement);
  Random random(6);
  const double pi = std::numbers::pi;
  for (int k = 0; k < 500; ++k) {
    const Vec2 uv(random.uniform(), random.uniform(0.15, 0.85));
    const auto at = placement->at(uv);
    REQUIRE(at);
    const Eigen::Matrix2d metres = placement->stretch(*at);
    // A triangle has the stretch of its own parallel, at most one band from here; it may differ by as much.
    const double latitude = pi * (uv.y() - 0.5), band = pi / 100;
    CHECK(metres(0, 0) == doctest::Approx(2 * pi * radius * std::cos(latitude))
                              .epsilon(std::tan(std::abs(latitude)) * band + band * band));
    CHECK(metres(1, 1) == doctest::Approx(pi * radius).epsilon(0.03));
    const Vec3 toward = at->weights + 1e-4 * Vec3(-1, 2, -1);  // along any direction within the triangle
    const BasePoint beside = placement->at(at->triangle, toward);
    const Vec3 local = at->direction_to_local(beside.point - at->point);
    CHECK((metres * (beside.uv - at->uv) - local.head<2>()).norm() < 1e-9);
  }
}

TEST_CASE("two builds of a mesh give the same bits, from any thread") {
  const auto first = MeshPlacement::make(wavy(40));
  const auto second = MeshPlacement::make(wavy(40));
  REQUIRE((first && second));
  std::array<int, 4> differing{};
  const auto compare = [&](std::size_t seed) {
    Random random(seed / 2);  // two threads ask the same, two others something else
    for (int k = 0; k < 2000; ++k) {
      // Also points above vertices and edges, where triangles tie.
      const Vec3 weights = k % 3 == 0 ? Vec3(1, 0, 0) : k % 3 == 1 ? Vec3(0.5, 0.5, 0) : any_weights(random);
      const Vec3 p = first->to_world(any_triangle(random, *first), weights, random.uniform(-0.02, 0.05));
      const auto a = first->closest(p, 0.1);
      const auto b = second->closest(p, 0.1);
      if (!a || !b || a->triangle != b->triangle || difference(*a, *b) != 0) ++differing[seed];
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t k = 0; k < differing.size(); ++k) threads.emplace_back(compare, k);
  for (std::thread& thread : threads) thread.join();
  CHECK(differing == std::array<int, 4>{});
}
