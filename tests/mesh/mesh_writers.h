// Writes mesh files of known meshes for the tests of src/mesh, and reads their errors.
#pragma once

#include <doctest/doctest.h>

#include <fmt/format.h>
#include <cstring>
#include <filesystem>
#include <limits>

#include "core/file.h"
#include "mesh/mesh_file.h"
#include "tests/mesh/mesh_shapes.h"
#include "tests/temporary_folder.h"

namespace intaglio::tests {

using namespace surface;

using Bytes = std::vector<std::uint8_t>;

inline std::string obj_of(const TriangleMesh& mesh) {
  std::string text = "# a shape\nmtllib none.mtl\no shape\n";
  for (const Vec3& p : mesh.positions) text += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
  for (const Vec2& uv : mesh.uvs) text += fmt::format("vt {} {}\r\n", uv.x(), uv.y());
  for (const Vec3& n : mesh.normals) text += fmt::format("vn {} {} {}\n", n.x(), n.y(), n.z());
  for (const auto& [a, b, c] : mesh.triangles)
    text += fmt::format("f {0}/{0}/{0} {1}/{1}/{1} {2}/{2}/{2}\n", a + 1, b + 1, c + 1);
  return text;
}

template <class T>
void append(Bytes& bytes, T value) {
  const auto at = bytes.size();
  bytes.resize(at + sizeof value);
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

// Positions, normals, UVs (v from the top, as glTF has it), indices.
inline Bytes buffer_of(const TriangleMesh& mesh) {
  Bytes bytes;
  for (const auto* list : {&mesh.positions, &mesh.normals}) {
    for (const Vec3& v : *list)
      for (const double x : v) append(bytes, float(x));
  }
  for (const Vec2& uv : mesh.uvs) {
    append(bytes, float(uv.x()));
    append(bytes, float(1 - uv.y()));
  }
  for (const Triangle& triangle : mesh.triangles)
    for (const int index : triangle) append(bytes, std::uint32_t(index));
  return bytes;
}

inline std::string base64(const Bytes& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    std::uint32_t bits = 0;
    for (std::size_t m = 0; m < 3; ++m) bits = bits << 8 | (k + m < bytes.size() ? bytes[k + m] : 0u);
    for (int shift = 18; shift >= 0; shift -= 6) text += digits[bits >> shift & 63];
  }
  for (std::size_t k = 0; k < (3 - bytes.size() % 3) % 3; ++k) text[text.size() - 1 - k] = '=';
  return text;
}

inline std::string gltf_of(const TriangleMesh& mesh, const std::string& uri,
                           const std::string& node = R"({"mesh": 0})") {
  const std::size_t n = mesh.positions.size(), m = 3 * mesh.triangles.size();
  return fmt::format(
      R"({{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}], "nodes": [{node}],
"meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}}, "indices": 3}}]}}],
"accessors": [{{"bufferView": 0, "componentType": 5126, "count": {n}, "type": "VEC3"}},
{{"bufferView": 0, "byteOffset": {n12}, "componentType": 5126, "count": {n}, "type": "VEC3"}},
{{"bufferView": 1, "componentType": 5126, "count": {n}, "type": "VEC2"}},
{{"bufferView": 2, "componentType": 5125, "count": {m}, "type": "SCALAR"}}],
"bufferViews": [{{"buffer": 0, "byteLength": {n24}}}, {{"buffer": 0, "byteOffset": {n24}, "byteLength": {n8}}},
{{"buffer": 0, "byteOffset": {n32}, "byteLength": {m4}}}],
"buffers": [{{{uri}"byteLength": {total}}}]}})",
      fmt::arg("node", node), fmt::arg("n", n), fmt::arg("m", m), fmt::arg("n8", 8 * n),
      fmt::arg("n12", 12 * n), fmt::arg("n24", 24 * n), fmt::arg("n32", 32 * n), fmt::arg("m4", 4 * m),
      fmt::arg("total", 32 * n + 4 * m), fmt::arg("uri", uri.empty() ? "" : "\"uri\": \"" + uri + "\", "));
}

inline std::string embedded(const TriangleMesh& mesh, const std::string& node = R"({"mesh": 0})") {
  return gltf_of(mesh, "data:application/octet-stream;base64," + base64(buffer_of(mesh)), node);
}

inline Bytes glb_of(const TriangleMesh& mesh) {
  std::string json = gltf_of(mesh, "");
  while (json.size() % 4 != 0) json += ' ';
  const Bytes buffer = buffer_of(mesh);
  Bytes bytes;
  append(bytes, std::uint32_t{0x46546c67});
  append(bytes, std::uint32_t{2});
  append(bytes, std::uint32_t(28 + json.size() + buffer.size()));
  append(bytes, std::uint32_t(json.size()));
  append(bytes, std::uint32_t{0x4e4f534a});
  bytes.insert(bytes.end(), json.begin(), json.end());
  append(bytes, std::uint32_t(buffer.size()));
  append(bytes, std::uint32_t{0x004e4942});
  bytes.insert(bytes.end(), buffer.begin(), buffer.end());
  return bytes;
}

inline std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

inline double difference(const TriangleMesh& a, const TriangleMesh& b) {
  if (a.triangles.size() != b.triangles.size()) return std::numeric_limits<double>::infinity();
  double worst = 0;
  for (std::size_t k = 0; k < a.triangles.size(); ++k) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto i = std::size_t(a.triangles[k][corner]), j = std::size_t(b.triangles[k][corner]);
      worst = std::max({worst, (a.positions[i] - b.positions[j]).norm(), (a.normals[i] - b.normals[j]).norm(),
                        (a.uvs[i] - b.uvs[j]).norm()});
    }
  }
  return worst;
}

// The error's one line.
template <class T>
std::string error_of(const Result<T>& result) {
  if (result) return "no error";
  const std::string message = result.error().message();
  CHECK(message.find('\n') == std::string::npos);
  CHECK(message.size() < 400);
  return message;
}

inline bool says(const std::string& message, const std::string& part) {
  const bool found = message.find(part) != std::string::npos;
  if (!found) MESSAGE("\"" << message << "\" does not say \"" << part << "\"");
  return found;
}

inline std::string changed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

struct Folder : TemporaryFolder {
  Folder() { std::filesystem::create_directories(path / "inner"); }
};

inline surface::TriangleMesh unit_quad() {
  return make_quad(Placement(Vec3::Zero(), Quat::Identity(), 1, 1));
}

}  // namespace intaglio::tests
