#include <doctest/doctest.h>

#include <cstring>
#include <limits>

#include "mesh/mesh_file.h"

using namespace intaglio;
using namespace intaglio::surface;

namespace {

std::vector<std::uint8_t> file_of(const std::string& text) {
  return {text.begin(), text.end()};
}

const std::string ascii =
    "solid thing with spaces\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 +2e0 "
    "0\n  endloop\n endfacet\nendsolid thing\n";

// One triangle; the header starts with "solid", as some careless writers have it.
std::vector<std::uint8_t> binary(std::uint32_t count, float last) {
  std::vector<std::uint8_t> bytes(84 + 50, 0);
  std::memcpy(bytes.data(), "solid", 5);
  std::memcpy(bytes.data() + 80, &count, 4);
  const float numbers[12] = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, last, 0};
  std::memcpy(bytes.data() + 84, numbers, sizeof numbers);
  return bytes;
}

}  // namespace

TEST_CASE("STL: ASCII and binary give the same triangle") {
  for (const auto& bytes : {file_of(ascii), binary(1, 2)}) {
    const auto mesh = parse_stl(bytes, "a.stl");
    REQUIRE(mesh);
    REQUIRE(mesh->triangles.size() == 1);
    const auto at = [&](std::size_t k) { return mesh->positions[std::size_t(mesh->triangles[0][k])]; };
    CHECK(at(1) == Vec3(1, 0, 0));
    CHECK(at(2) == Vec3(0, 2, 0));
  }
}

TEST_CASE("malformed STL is one clear error") {
  const auto error = [](const std::vector<std::uint8_t>& bytes) {
    const auto mesh = parse_stl(bytes, "a.stl");
    REQUIRE_FALSE(mesh);
    const std::string message = mesh.error().message();
    CHECK(message.starts_with("a.stl"));
    CHECK(message.find('\n') == std::string::npos);
    return message;
  };
  CHECK(error({}).find("not an STL") != std::string::npos);
  CHECK(error(file_of("nonsense")).find("not an STL") != std::string::npos);
  CHECK(error(file_of("solid\nendsolid\n")).find("no triangles") != std::string::npos);
  CHECK(error(file_of(ascii.substr(0, ascii.find("   vertex 0 +")))).find("cut off") != std::string::npos);
  CHECK(error(file_of(ascii.substr(0, ascii.find("2e0")))).find(":6: a number of a vertex") !=
        std::string::npos);
  CHECK(error(binary(1, std::numeric_limits<float>::quiet_NaN())).find("not finite") != std::string::npos);
  error(binary(2, 2));
  error(binary(0xffffffff, 2));
  CHECK(error(binary(1, 0)).find("without area") != std::string::npos);
}

TEST_CASE("a mesh for its shape alone needs no UVs") {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1 2 3\nf 1//1 3//1 2//1\n";
  CHECK_FALSE(parse_obj(obj, "a.obj"));
  const auto mesh = parse_obj(obj, "a.obj", MeshUse::shape);
  REQUIRE(mesh);
  CHECK(mesh->triangles.size() == 2);
}
