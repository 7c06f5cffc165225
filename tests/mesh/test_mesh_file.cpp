#include "tests/mesh/mesh_writers.h"

#include <fmt/format.h>

using namespace intaglio;
using namespace intaglio::tests;

TEST_CASE("a shape is the same mesh from OBJ, glTF, GLB and glTF with a side buffer") {
  const Folder folder;
  for (const TriangleMesh& shape : {make_sphere(0.5, 16, 8), make_bowl(2, 7, 3),
                                    make_quad(Placement(Vec3::Zero(), Quat::Identity(), 2, 3))}) {
    const auto whole = checked(shape, "shape");
    REQUIRE(whole);
    const auto obj = parse_obj(obj_of(shape), "shape.obj");
    REQUIRE_MESSAGE(obj, error_of(obj));
    CHECK(difference(*obj, *whole) < 1e-15);
    CHECK(obj->notes.empty());
    const auto gltf = parse_gltf(bytes_of(embedded(shape)), "shape.gltf");
    REQUIRE_MESSAGE(gltf, error_of(gltf));
    CHECK(difference(*gltf, *whole) < 1e-6);  // glTF is in single precision
    const auto glb = parse_gltf(glb_of(shape), "shape.glb");
    REQUIRE_MESSAGE(glb, error_of(glb));
    CHECK(difference(*glb, *gltf) == 0);
    REQUIRE(write_file(folder.path / "inner/a b.bin", buffer_of(shape)));
    REQUIRE(write_file(folder.path / "shape.gltf", gltf_of(shape, "inner/a%20b.bin")));
    const auto side = surface::read_mesh(folder.path / "shape.gltf");
    REQUIRE_MESSAGE(side, error_of(side));
    CHECK(difference(*side, *gltf) == 0);
  }
}

TEST_CASE("a glTF node's transform moves the mesh; a mirroring one keeps its outside") {
  const TriangleMesh sphere = make_sphere(0.5, 12, 6);
  const auto at = parse_gltf(
      bytes_of(embedded(
          sphere,
          R"({"mesh": 0, "translation": [1, 2, 3], "rotation": [0, 0.6, 0, 0.8], "scale": [2, 2, 2]})")),
      "a");
  REQUIRE_MESSAGE(at, error_of(at));
  TriangleMesh larger = make_sphere(1, 12, 6);
  const auto expected = checked(moved(larger, {Vec3(1, 2, 3), Quat(0.8, 0, 0.6, 0)}), "b");
  REQUIRE(expected);
  CHECK(difference(*at, *expected) < 1e-6);
  const auto mirrored = parse_gltf(
      bytes_of(embedded(sphere, R"({"mesh": 0, "matrix": [-1,0,0,0, 0,3,0,0, 0,0,1,0, 0,0,0,1]})")), "c");
  REQUIRE_MESSAGE(mirrored, error_of(mirrored));
  CHECK(mirrored->notes.empty());  // the windings agree with the normals without repair
  const auto placement = MeshPlacement::make(*mirrored);
  REQUIRE(placement);
  const BasePoint out = placement->at(3, Vec3::Constant(1.0 / 3));
  CHECK(out.n.dot(out.point) > 0);
  CHECK(out.t.cross(out.b).dot(out.n) == doctest::Approx(-1));  // its texture is mirrored
}

TEST_CASE("missing and degenerate parts are repaired and noted") {
  const TriangleMesh sphere = make_sphere(0.5, 32, 16);
  std::string bare;
  for (std::size_t k = 0; k < sphere.positions.size(); ++k) {
    const Vec3& p = sphere.positions[k];
    bare += fmt::format("v {} {} {}\nvt {} {}\n", p.x(), p.y(), p.z(), sphere.uvs[k].x(), sphere.uvs[k].y());
  }
  for (const auto& [a, b, c] : sphere.triangles)
    bare += fmt::format("f {0}/{0} {1}/{1} {2}/{2}\n", a + 1, b + 1, c + 1);
  bare += "f 1/1 2/2 2/2\n";
  const auto mesh = parse_obj(bare, "bare.obj");
  REQUIRE_MESSAGE(mesh, error_of(mesh));
  CHECK(mesh->triangles.size() == sphere.triangles.size());
  REQUIRE(mesh->notes.size() == 2);
  CHECK(says(mesh->notes[0], "1 of"));
  CHECK(says(mesh->notes[1], "normals were missing"));
  // Across the seam too: the computed normals are those of a sphere.
  for (const Triangle& triangle : mesh->triangles) {
    for (const int index : triangle)
      CHECK(mesh->normals[std::size_t(index)].dot(mesh->positions[std::size_t(index)]) > 0.995 * 0.5);
  }
  TriangleMesh inside_out = unit_quad();
  for (Triangle& triangle : inside_out.triangles) std::swap(triangle[0], triangle[1]);
  const auto turned = checked(inside_out, "quad");
  REQUIRE(turned);
  CHECK(says(turned->notes.at(0), "2 triangles were flipped"));
  CHECK(checked(*turned, "again")->notes.size() == 1);
}

TEST_CASE("polygons become fans, and indices count back from the end") {
  const auto mesh = parse_obj(
      "v 0 0 0\nv 1 0 0\nv 1 0 -1\nv 0 0 -1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf -4/-4 -3/-3 -2/-2 -1/-1\n",
      "square.obj");
  REQUIRE_MESSAGE(mesh, error_of(mesh));
  const auto quad = checked(make_quad(Placement(Vec3(0.5, 0, -0.5), Quat::Identity(), 1, 1)), "quad");
  CHECK(difference(*mesh, *quad) < 1e-15);
}
