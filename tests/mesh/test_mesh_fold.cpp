#include <doctest/doctest.h>

#include <limits>

#include "mesh/base_patch.h"
#include "tests/mesh/mesh_shapes.h"

using namespace intaglio;
using namespace intaglio::surface;
using namespace intaglio::tests;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

double fold_of(const TriangleMesh& mesh) {
  const auto placement = MeshPlacement::make(mesh);
  REQUIRE(placement);
  return placement->fold_depth();
}

// The triangle that folds first.
int fold_triangle(const MeshPlacement& placement) {
  for (int k = 0; k < int(placement.mesh().triangles.size()); ++k) {
    if (fold_depth(patch_of(placement.mesh(), k)) == placement.fold_depth()) return k;
  }
  return -1;
}

// The volume that a step in the weights and one in depth sweeps, by differences of to_world: its sign tells a
// fold.
double jacobian(const MeshPlacement& placement, int triangle, const Vec3& w, double height) {
  const double e = 1e-5;
  const auto step = [&](const Vec3& by, double up) {
    return Vec3(placement.to_world(triangle, w + e * by, height + e * up) -
                placement.to_world(triangle, w - e * by, height - e * up));
  };
  return step({-1, 1, 0}, 0).cross(step({-1, 0, 1}, 0)).dot(step({0, 0, 0}, 1)) / (8 * e * e * e);
}

}  // namespace

TEST_CASE("relief folds at the radius of curvature") {
  for (const double radius : {0.02, 0.5, 30.0}) {
    CHECK(fold_of(make_sphere(radius, 128, 64)) == doctest::Approx(radius).epsilon(0.002));
    CHECK(fold_of(make_cylinder(radius, 1, 128, 4)) == doctest::Approx(radius).epsilon(0.002));
    CHECK(fold_of(make_bowl(radius, 128, 64)) == inf);
  }
  CHECK(fold_of(make_quad(Placement(Vec3::Zero(), Quat::Identity(), 2, 3))) == inf);
}

TEST_CASE("a spheroid folds first at its sharpest place, b^2 / a") {
  TriangleMesh mesh = make_sphere(1, 256, 512);
  const double a = 2, b = 1;
  for (Vec3& p : mesh.positions) p = Vec3(b * p.x(), a * p.y(), b * p.z());
  for (Vec3& n : mesh.normals) n = Vec3(n.x() / b, n.y() / a, n.z() / b);
  const auto placement = MeshPlacement::make(mesh);
  REQUIRE(placement);
  CHECK(placement->fold_depth() == doctest::Approx(b * b / a).epsilon(0.01));
  // At a tip, which is a pole.
  CHECK(std::abs(placement->at(fold_triangle(*placement), Vec3::Constant(1.0 / 3)).point.y()) > 0.99 * a);
}

TEST_CASE("a scaled mesh folds at the scaled depth") {
  const double depth = fold_of(wavy(24));
  for (const double scale : {0.001, 7.0}) {
    TriangleMesh mesh = wavy(24);
    for (Vec3& p : mesh.positions) p *= scale;
    CHECK(fold_of(mesh) == doctest::Approx(scale * depth).epsilon(1e-9));
  }
}

TEST_CASE(
    "above the fold the map keeps its orientation everywhere; just below it turns at the triangle that is "
    "named") {
  const auto placement = MeshPlacement::make(wavy(24));
  REQUIRE(placement);
  const double depth = placement->fold_depth();
  REQUIRE(depth < 1);
  const std::vector<Vec3> places = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.4, 0.3, 0.3}};
  for (int k = 0; k < int(placement->mesh().triangles.size()); ++k) {
    for (const Vec3& w : places) CHECK(jacobian(*placement, k, w, -0.98 * depth) > 0);
  }
  bool turned = false;
  for (const Vec3& w : places)
    turned = turned || jacobian(*placement, fold_triangle(*placement), w, -1.03 * depth) < 0;
  CHECK(turned);
}

TEST_CASE("a depth that folds is refused with the triangle, the radius and what would do") {
  const auto placement = MeshPlacement::make(make_cylinder(0.25, 1, 256, 4), "pipe.obj");
  REQUIRE(placement);
  CHECK(placement->check_depth(0.2));
  const auto refused = placement->check_depth(0.3);
  REQUIRE_FALSE(refused);
  const std::string message = refused.error().message();
  CHECK(message.find("pipe.obj: relief 0.3 m deep folds at triangle") == 0);
  CHECK(message.find("radius of curvature is 0.25 m") != std::string::npos);
  CHECK(message.find("must be less than 0.25 m") != std::string::npos);
}

TEST_CASE("normals that face away from a triangle allow no relief and have no base point there") {
  TriangleMesh mesh = make_quad(Placement(Vec3::Zero(), Quat::Identity(), 1, 1));
  mesh.normals[1] = Vec3(0.9, -0.1, 0);
  const auto placement = MeshPlacement::make(mesh);
  REQUIRE(placement);
  CHECK(placement->fold_depth() == 0);
  CHECK_FALSE(placement->check_depth(0.001));
  CHECK_FALSE(placement->closest(placement->to_world(0, Vec3(0.02, 0.96, 0.02), 0.001), 0.01));
  CHECK(placement->closest(placement->to_world(0, Vec3(0.02, 0.02, 0.96), 0.001), 0.01));
}
