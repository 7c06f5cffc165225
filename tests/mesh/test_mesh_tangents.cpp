#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <numeric>

#include "core/portable_math.h"
#include "tests/mesh/mesh_shapes.h"

using namespace intaglio;
using namespace intaglio::surface;
using namespace intaglio::tests;

namespace {

// The same mesh with its vertices, its triangles and the first corner of each in another order.
TriangleMesh shuffled(const TriangleMesh& mesh, std::uint64_t seed) {
  Random random(seed);
  const auto order = [&](std::size_t n) {
    std::vector<std::size_t> list(n);
    std::iota(list.begin(), list.end(), std::size_t{0});
    for (std::size_t k = n; k > 1; --k) std::swap(list[k - 1], list[random.next() % k]);
    return list;
  };
  TriangleMesh other = mesh;
  std::vector<int> place(mesh.positions.size());
  const auto vertices = order(mesh.positions.size());
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    place[vertices[k]] = int(k);
    other.positions[k] = mesh.positions[vertices[k]];
    other.normals[k] = mesh.normals[vertices[k]];
    other.uvs[k] = mesh.uvs[vertices[k]];
  }
  const auto triangles = order(mesh.triangles.size());
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    for (std::size_t corner = 0; corner < 3; ++corner)
      other.triangles[k][corner] = place[std::size_t(mesh.triangles[triangles[k]][(corner + seed) % 3])];
  }
  return other;
}

// Two squares side by side in x; the texture of the right one is the mirror image of the left one's, and they
// share an edge.
TriangleMesh mirrored_pair() {
  TriangleMesh mesh;
  for (const double x : {-1.0, 0.0, 1.0}) {
    for (const double up : {0.0, 1.0}) {
      mesh.positions.emplace_back(x, 0, -up);
      mesh.normals.emplace_back(Vec3::UnitY());
      mesh.uvs.emplace_back(1 - std::abs(x), up);
    }
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {2, 4, 5}, {2, 5, 3}};
  return mesh;
}

}  // namespace

TEST_CASE("frames are orthonormal everywhere") {
  for (const TriangleMesh& mesh :
       {wavy(9), make_sphere(1, 12, 7), make_bowl(1, 5, 3), make_cylinder(1, 1, 3, 1), mirrored_pair()}) {
    const auto placement = MeshPlacement::make(mesh);
    REQUIRE(placement);
    CHECK(rc::check("orthonormal", [&] {
      Random random(*rc::gen::arbitrary<std::uint64_t>());
      const BasePoint at = placement->at(any_triangle(random, *placement), any_weights(random), 0);
      Mat3 frame;
      frame << at.t, at.b, at.n;
      RC_ASSERT((frame.transpose() * frame - Mat3::Identity()).norm() < 1e-14);
      RC_ASSERT((at.direction_to_world(at.direction_to_local(Vec3(1, 2, 3))) - Vec3(1, 2, 3)).norm() < 1e-13);
    }));
  }
}

TEST_CASE("on a sphere t points east and b north; inside a bowl the texture is seen from inside") {
  const auto sphere = MeshPlacement::make(make_sphere(2, 64, 32));
  const auto bowl = MeshPlacement::make(make_bowl(2, 64, 16));
  REQUIRE((sphere && bowl));
  Random random(8);
  for (int k = 0; k < 500; ++k) {
    const auto at = sphere->at(Vec2(random.uniform(), random.uniform(0.1, 0.9)));
    REQUIRE(at);
    const Vec3 east = Vec3::UnitY().cross(at->n).normalized();
    CHECK(at->t.dot(east) > 0.999);
    CHECK(at->b.dot(at->n.cross(east)) > 0.999);
    const auto inside = bowl->at(Vec2(random.uniform(), random.uniform(0.2, 0.9)));
    REQUIRE(inside);
    CHECK(inside->n.dot(inside->point) < 0);
    CHECK(inside->t.cross(inside->b).dot(inside->n) > 0.999);
    CHECK(inside->b.y() > 0);  // v goes up to the rim
  }
}

TEST_CASE("mirrored UVs are kept apart along the edge that they share") {
  const auto placement = MeshPlacement::make(mirrored_pair());
  REQUIRE(placement);
  for (int triangle = 0; triangle < 4; ++triangle) {
    const double side = triangle < 2 ? 1 : -1;
    for (const Vec3& weights : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0.2, 0.3, 0.5)}) {
      const BasePoint at = placement->at(triangle, weights);
      CHECK((at.t - side * Vec3::UnitX()).norm() < 1e-14);
      CHECK((at.b - -Vec3::UnitZ()).norm() < 1e-14);
      CHECK(at.t.cross(at.b).dot(at.n) == doctest::Approx(side));
    }
  }
}

TEST_CASE("the order of vertices, triangles and corners does not matter") {
  const auto mesh = checked(wavy(10), "wavy");
  REQUIRE(mesh);
  const auto placement = MeshPlacement::make(*mesh);
  REQUIRE(placement);
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const auto other = MeshPlacement::make(shuffled(*mesh, seed));
    REQUIRE(other);
    CHECK(other->fold_depth() == doctest::Approx(placement->fold_depth()).epsilon(1e-12));
    Random random(seed);
    for (int k = 0; k < 300; ++k) {
      const Vec2 uv(random.uniform(), random.uniform());
      const auto a = placement->at(uv);
      const auto b = other->at(uv);
      REQUIRE((a && b));
      CHECK((a->t - b->t).norm() + (a->b - b->b).norm() + (a->point - b->point).norm() < 1e-12);
    }
  }
}

TEST_CASE("vertices stored twice are one, unless their normals or UVs differ") {
  const auto mesh = checked(wavy(6), "wavy");
  REQUIRE(mesh);
  TriangleMesh soup;
  for (const Triangle& triangle : mesh->triangles) {
    const int first = int(soup.positions.size());
    for (const int index : triangle) {
      soup.positions.push_back(mesh->positions[std::size_t(index)]);
      soup.normals.push_back(mesh->normals[std::size_t(index)]);
      soup.uvs.push_back(mesh->uvs[std::size_t(index)]);
    }
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  const CornerTangents a = corner_tangents(*mesh);
  const CornerTangents b = corner_tangents(soup);
  for (std::size_t k = 0; k < a.t.size(); ++k) {
    for (std::size_t corner = 0; corner < 3; ++corner)
      CHECK((a.t[k][corner] - b.t[k][corner]).norm() < 1e-12);
  }
}
