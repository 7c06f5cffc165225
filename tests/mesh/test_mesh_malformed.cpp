#include "tests/mesh/mesh_writers.h"

using namespace intaglio;
using namespace intaglio::tests;

TEST_CASE("a malformed OBJ gives one line that says where") {
  const std::string good = "v 0 0 0\nv 1 0 0\nv 1 0 -1\nvt 0 0\nvt 1 0\nvt 1 1\n";
  const auto error = [&](const std::string& more) { return error_of(parse_obj(good + more, "a.obj")); };
  CHECK(error("f 1/1 2/2 3/3\n") == "no error");
  CHECK(says(error("v nan 0 0\n"), "a.obj:7: number 1 of a position is missing or not finite"));
  CHECK(says(error("v 0 1e999 0\n"), "a.obj:7: number 2"));
  CHECK(says(error("v 1 2\n"), "number 3"));
  CHECK(says(error("f 1/1 2/2 4/3\n"), "a.obj:7: a face refers to a missing position"));
  CHECK(says(error("f 1/1 2/9 3/3\n"), "refers to a missing UV"));
  CHECK(says(error("f 1/1/1 2/2/1 3/3/1\n"), "refers to a missing normal"));
  CHECK(says(error("f 0/1 2/2 3/3\n"), "a missing position"));
  CHECK(says(error("f -4/1 2/2 3/3\n"), "a missing position"));
  CHECK(says(error("f 99999999999999999999/1 2/2 3/3\n"), "a missing position"));
  CHECK(says(error("f 1 2 3\n"), "a face has no UVs"));
  CHECK(says(error("f 1/1 2/2\n"), "a face has 2 corners"));
  CHECK(says(error("f 1/1 2/2 \\\n3/3\n"), "write each statement on one line"));
  CHECK(says(error(""), "has no triangles"));
  CHECK(says(error("f 1/1 2/2 2/2\n"), "only triangles without area"));
  CHECK(says(error("v 1e7 0 0\nf 4/1 2/2 3/3\n"), "beyond 1000000 m"));
}

TEST_CASE("a malformed glTF gives one line that says where") {
  const std::string good = embedded(unit_quad());
  const auto error = [&](const std::string& from, const std::string& to) {
    return error_of(parse_gltf(bytes_of(changed(good, from, to)), "a.gltf"));
  };
  CHECK(error("2.0", "2.0") == "no error");
  CHECK(says(error("2.0", "1.0"), "is not glTF 2"));
  CHECK(says(error("\"count\": 4", "\"count\": 999999"), "accessors[0]: needs 999999 elements"));
  CHECK(says(error("\"count\": 4", "\"count\": 18446744073709551615"),
             "accessors[0].count: is 18446744073709551615"));
  CHECK(says(error("\"count\": 4", "\"count\": -1"), "accessors[0].count: is -1"));
  CHECK(says(error("\"count\": 4", "\"count\": 3"), "have different counts"));
  CHECK(says(error("\"count\": 6", "\"count\": 5"), "not a multiple of 3"));
  CHECK(says(error("\"byteOffset\": 96", "\"byteOffset\": 9600"), "ends at byte"));
  CHECK(says(error("\"bufferView\": 1", "\"bufferView\": 9"),
             "bufferViews[9]: is referenced but does not exist"));
  CHECK(says(error("\"buffer\": 0", "\"buffer\": 1"), "buffers[1]: is referenced but does not exist"));
  CHECK(says(error("5126", "5124"), "has the wrong type"));
  CHECK(says(error("\"VEC3\"", "\"VEC4\""), "has the wrong type"));
  CHECK(says(error("\"TEXCOORD_0\": 2", "\"COLOR_0\": 2"), "has no UVs"));
  CHECK(says(error("{\"mesh\": 0}", "{\"children\": [0]}"), "is part of a cycle"));
  CHECK(says(error("{\"mesh\": 0}", "{\"mesh\": 7}"), "meshes[7]"));
  CHECK(says(error("\"scene\": 0", "\"scene\": \"x\""), "scene: is string"));
  CHECK(says(error("\"scene\": 0", "\"extensionsRequired\": [\"KHR_draco\\n_mesh\"]"), "KHR_draco?_mesh"));
  CHECK(says(error("base64,", "base64,*"), "buffers[0].uri: is data:"));
  CHECK(
      says(error_of(parse_gltf(bytes_of(good.substr(0, good.size() / 2)), "a.gltf")), "JSON cannot be read"));
  CHECK(says(error_of(parse_gltf({}, "a.gltf")), "JSON cannot be read"));
  CHECK(says(error_of(parse_gltf(bytes_of(std::string(1 << 20, '[')), "a.gltf")), "JSON cannot be read"));
}

TEST_CASE("wrong numbers inside a glTF buffer are found") {
  const TriangleMesh quad = unit_quad();
  TriangleMesh mesh = quad;
  mesh.positions[2].y() = std::nan("");
  CHECK(says(error_of(parse_gltf(glb_of(mesh), "a.glb")), "vertex 2: its position is not finite"));
  mesh = quad;
  mesh.normals[1].x() = std::numeric_limits<double>::infinity();
  CHECK(says(error_of(parse_gltf(glb_of(mesh), "a.glb")), "vertex 1: its normal is not finite"));
  mesh = quad;
  mesh.triangles[1][2] = 4;
  CHECK(says(error_of(parse_gltf(glb_of(mesh), "a.glb")), "triangle 1 uses vertex 4 of 4"));
}

TEST_CASE("a GLB cut off anywhere is an error on one line") {
  const Bytes whole = glb_of(unit_quad());
  REQUIRE(parse_gltf(whole, "a.glb"));
  for (std::size_t size = 0; size < whole.size(); ++size)
    CHECK(error_of(parse_gltf(std::span(whole).first(size), "a.glb")) != "no error");
  Bytes long_chunk = whole;
  std::memset(long_chunk.data() + 12, 0xff, 4);
  CHECK(says(error_of(parse_gltf(long_chunk, "a.glb")), "longer than the file"));
}

TEST_CASE("a glTF cannot reach out of its folder") {
  const Folder folder;
  const TriangleMesh quad = unit_quad();
  const auto path = folder.path / "inner/a.gltf";
  REQUIRE(write_file(folder.path / "secret.bin", buffer_of(quad)));
  const auto error = [&](const std::string& uri) {
    REQUIRE(write_file(path, gltf_of(quad, uri)));
    return error_of(surface::read_mesh(path));
  };
  const std::string absolute = (folder.path / "secret.bin").string();
  for (const std::string& uri :
       {std::string("../secret.bin"), std::string("%2e%2e/secret.bin"), std::string("x/../../secret.bin"),
        absolute, "file://" + absolute, std::string("http://example.org/a.bin"),
        std::string("..\\\\secret.bin"), std::string("a%00b.bin")})
    CHECK_MESSAGE(says(error(uri), "use embedded base64 data or a file in the same folder"), uri);
  std::filesystem::create_symlink(folder.path / "secret.bin", folder.path / "inner/link.bin");
  CHECK(says(error("link.bin"), "outside its folder"));
  CHECK(says(error("absent.bin"), "no such file"));
  REQUIRE(write_file(folder.path / "inner/short.bin", "abc"));
  CHECK(says(error("short.bin"), "bytes but has 3"));
  std::filesystem::copy_file(folder.path / "secret.bin", folder.path / "inner/plain.bin");
  CHECK(error("plain.bin") == "no error");
}

TEST_CASE("read_mesh names the formats that it reads") {
  CHECK(says(error_of(surface::read_mesh("a.stl")), "use .obj, .gltf or .glb"));
  CHECK(says(error_of(surface::read_mesh("absent.obj")), "no such file"));
}
