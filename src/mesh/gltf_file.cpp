#include "mesh/gltf_file.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <fmt/format.h>

#include "mesh/gltf_json.h"
#include "mesh/mesh_file.h"

namespace intaglio::surface {

namespace {

constexpr int unsigned_byte = 5121, unsigned_short = 5123, unsigned_int = 5125, single_float = 5126;
constexpr std::size_t max_stride = 252;

std::size_t bytes_of(int component_type) {
  switch (component_type) {
    case unsigned_byte:
      return 1;
    case unsigned_short:
      return 2;
    case unsigned_int:
    case single_float:
      return 4;
    default:
      return 0;
  }
}

bool allowed(GltfBuffers::Component component, int type, bool normalised) {
  const bool small = type == unsigned_byte || type == unsigned_short;
  switch (component) {
    case GltfBuffers::Component::floats:
      return type == single_float;
    case GltfBuffers::Component::normalised:
      return type == single_float || (small && normalised);
    case GltfBuffers::Component::indices:
      return small || type == unsigned_int;
  }
  return false;
}

}  // namespace

std::uint32_t Elements::unsigned_at(std::size_t k, std::size_t c) const {
  std::uint32_t value = 0;
  for (std::size_t byte = 0; byte < component_bytes; ++byte)  // little-endian, whatever the machine
    value |= static_cast<std::uint32_t>(bytes[k * stride + c * component_bytes + byte]) << (8 * byte);
  return value;
}

double Elements::fraction(std::size_t k, std::size_t c) const {
  const std::uint32_t bits = unsigned_at(k, c);
  if (component_type == unsigned_byte) return bits / 255.0;
  if (component_type == unsigned_short) return bits / 65535.0;
  float value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return static_cast<double>(value);
}

std::size_t Elements::index(std::size_t k) const {
  return unsigned_at(k, 0);
}

GltfBuffers::GltfBuffers(JsonValue root, std::span<const std::uint8_t> glb_chunk, SideBuffers side_buffers)
    : root_(std::move(root)),
      glb_chunk_(glb_chunk),
      side_buffers_(std::move(side_buffers)),
      loaded_(root_["buffers"].size()) {}

std::vector<std::uint8_t> GltfBuffers::load(const JsonValue& json) {
  const JsonValue uri = json["uri"];
  const std::string text = uri.text();
  if (auto bytes = data_uri(text)) return std::move(*bytes);
  const auto name = side_file(text);
  if (!name) {
    uri.fail("is " + printable(text), "a buffer is base64 data or a file beside this one");
    return {};
  }
  if (!side_buffers_) {
    uri.fail("names a side file", "only embedded buffers can be read from memory");
    return {};
  }
  auto bytes = side_buffers_(*name, max_mesh_file_bytes - loaded_bytes_);
  if (bytes) return std::move(*bytes);
  uri.fail(bytes.error().message());
  return {};
}

std::span<const std::uint8_t> GltfBuffers::buffer(std::size_t index) {
  const JsonValue json = root_["buffers"][index];
  if (!json) return {};
  std::span<const std::uint8_t> bytes = glb_chunk_;
  if (json["uri"]) {
    auto& loaded = loaded_[index];
    if (!loaded) {
      loaded = load(json);
      loaded_bytes_ += std::min(loaded->size(), max_mesh_file_bytes - loaded_bytes_);
    }
    bytes = *loaded;
  }
  const std::size_t length = json["byteLength"].required_whole(max_mesh_file_bytes);
  if (length > bytes.size()) {
    json.fail(fmt::format("has {} bytes of the {} that it declares", bytes.size(), length),
              "is the file cut off?");
    return {};
  }
  return bytes.first(length);
}

Elements GltfBuffers::elements(std::size_t index, const char* type, std::size_t components,
                               Component component) {
  const JsonValue json = root_["accessors"][index];
  if (!json) return {};
  if (json["sparse"] || !json["bufferView"]) {
    json.fail("is sparse or has no data", "export without sparse accessors");
    return {};
  }
  Elements elements;
  elements.component_type = static_cast<int>(json["componentType"].required_whole(65535));
  elements.component_bytes = bytes_of(elements.component_type);
  if (json["type"].text() != type ||
      !allowed(component, elements.component_type, json["normalized"].truth(false))) {
    json.fail("has the wrong type for its use", fmt::format("{} of a type that glTF 2.0 allows there", type));
    return {};
  }
  const JsonValue view = root_["bufferViews"][json["bufferView"].required_whole(max_mesh_file_bytes)];
  if (!view) return {};
  const auto bytes = buffer(view["buffer"].required_whole(max_mesh_file_bytes));
  const std::size_t begin = view["byteOffset"].whole(0, max_mesh_file_bytes);
  const std::size_t length = view["byteLength"].required_whole(max_mesh_file_bytes);
  const std::size_t offset = json["byteOffset"].whole(0, max_mesh_file_bytes);
  const std::size_t element = components * elements.component_bytes;
  elements.stride = view["byteStride"].whole(element, max_stride);
  elements.count = json["count"].required_whole(max_mesh_file_bytes);
  // All of these are at most 2^28 and the stride 252: no sum or product below overflows 64 bits.
  if (begin + length > bytes.size()) {
    view.fail(fmt::format("ends at byte {} of a buffer of {}", begin + length, bytes.size()));
    return {};
  }
  if (elements.stride < element || elements.count == 0 ||
      offset + (elements.count - 1) * elements.stride + element > length) {
    json.fail(fmt::format("asks for {} elements, more than its buffer view of {} bytes holds", elements.count,
                          length));
    return {};
  }
  elements.bytes = bytes.subspan(begin + offset, length - offset);
  return elements;
}

// glTF 2.0: the container, the scene's nodes, and the triangles of their meshes.

namespace {

using Transform = Eigen::Affine3d;

constexpr std::size_t max_list = max_mesh_file_bytes;  // any index: none can be larger than the file
constexpr int max_depth = 64;                          // of the tree of nodes
constexpr int triangles_mode = 4;

struct Chunks {
  std::span<const std::uint8_t> json, binary;
};

std::uint32_t little_endian(std::span<const std::uint8_t> bytes, std::size_t at) {
  return bytes[at] | static_cast<std::uint32_t>(bytes[at + 1]) << 8 |
         static_cast<std::uint32_t>(bytes[at + 2]) << 16 | static_cast<std::uint32_t>(bytes[at + 3]) << 24;
}

// A GLB is a header of 12 bytes, then chunks of length, type, bytes: first JSON, then perhaps BIN.
Result<Chunks> split(std::span<const std::uint8_t> bytes, const std::string& name) {
  constexpr std::uint32_t glb_magic = 0x46546c67, json_type = 0x4e4f534a, binary_type = 0x004e4942;
  if (bytes.size() < 4 || little_endian(bytes, 0) != glb_magic) return Chunks{bytes, {}};
  if (bytes.size() < 20) return fail(name, "is a GLB file that ends in its header", "is the file cut off?");
  if (little_endian(bytes, 4) != 2)
    return fail(name, fmt::format("is GLB version {}", little_endian(bytes, 4)), "version 2 is read");
  if (little_endian(bytes, 8) > bytes.size())
    return fail(name,
                fmt::format("has {} bytes of the {} that it declares", bytes.size(), little_endian(bytes, 8)),
                "is the file cut off?");
  Chunks chunks;
  for (std::size_t at = 12; at + 8 <= bytes.size();) {
    const std::size_t length = little_endian(bytes, at);
    if (length > bytes.size() - at - 8)
      return fail(name, fmt::format("byte {}: a chunk of {} bytes is longer than the file", at, length));
    const auto chunk = bytes.subspan(at + 8, length);
    const std::uint32_t type = little_endian(bytes, at + 4);
    if (type == json_type && chunks.json.empty()) chunks.json = chunk;
    if (type == binary_type && chunks.binary.empty()) chunks.binary = chunk;
    at += 8 + length;
  }
  return chunks;
}

// The JSON of the file, without exceptions; nesting is bounded because each level costs memory many times its
// text.
nlohmann::json parse_json(std::span<const std::uint8_t> text) {
  constexpr int deepest = 100;
  const auto shallow = [](int depth, nlohmann::json::parse_event_t, const nlohmann::json&) {
    return depth <= deepest;
  };
  return nlohmann::json::parse(text.begin(), text.end(), shallow, false);
}

class GltfReader {
 public:
  GltfReader(const nlohmann::json& json, std::span<const std::uint8_t> binary, const std::string& name,
             const SideBuffers& side_buffers, MeshUse use)
      : root_(&json, "", name, error_), buffers_(root_, binary, side_buffers), name_(name), use_(use) {}

  Result<TriangleMesh> read() {
    check_asset();
    const JsonValue scenes = root_["scenes"];
    visited_.assign(root_["nodes"].size(), false);
    if (scenes.size() > 0) {
      const JsonValue roots = scenes[root_["scene"].whole(0, max_list)]["nodes"];
      for (std::size_t k = 0; k < roots.size() && !error_; ++k)
        read_node(roots[k].required_whole(max_list), Transform::Identity(), 0);
    } else {
      for (std::size_t k = 0; k < root_["meshes"].size() && !error_; ++k) read_mesh(k, Transform::Identity());
    }
    if (error_) return tl::unexpected(*error_);
    if (skipped_ > 0)
      mesh_.notes.push_back(fmt::format("{} lists of points or lines were not read", skipped_));
    return checked(std::move(mesh_), name_);
  }

 private:
  void check_asset() {
    if (!root_["asset"]["version"].text().starts_with("2"))
      root_["asset"].fail("is not glTF 2", "version 2.0 is read");
    const JsonValue required = root_["extensionsRequired"];
    for (std::size_t k = 0; k < required.size() && !error_; ++k) {
      const std::string extension = required[k].text();
      const auto only_looks = {"KHR_materials_", "KHR_lights_", "KHR_texture_basisu", "EXT_texture_webp"};
      if (std::none_of(only_looks.begin(), only_looks.end(),
                       [&](const char* prefix) { return extension.starts_with(prefix); }))
        required[k].fail("is " + printable(extension) + ", which is not read", "export without it");
    }
  }

  // A node may be reached once only: that is what makes the nodes a tree, and a cycle an error.
  void read_node(std::size_t index, const Transform& parent, int depth) {
    const JsonValue node = root_["nodes"][index];
    if (!node || error_) return;
    if (visited_[index] || depth > max_depth)
      return node.fail("is its own ancestor, has two parents, or lies too deep");
    visited_[index] = true;
    const Transform world = parent * local_transform(node);
    if (node["mesh"]) read_mesh(node["mesh"].required_whole(max_list), world);
    const JsonValue children = node["children"];
    for (std::size_t k = 0; k < children.size() && !error_; ++k)
      read_node(children[k].required_whole(max_list), world, depth + 1);
  }

  static Transform local_transform(const JsonValue& node) {
    Transform transform = Transform::Identity();
    if (const JsonValue matrix = node["matrix"]) {
      for (int k = 0; k < 16; ++k) {
        const double value = matrix[static_cast<std::size_t>(k)].number(0);
        if (k % 4 < 3) transform.matrix()(k % 4, k / 4) = value;
      }
      return transform;
    }
    const auto numbers = [](const JsonValue& list, auto fallback) {
      if (!list) return fallback;
      for (Eigen::Index k = 0; k < fallback.size(); ++k)
        fallback[k] = list[static_cast<std::size_t>(k)].number(0);
      return fallback;
    };
    const Eigen::Vector4d xyzw = numbers(node["rotation"], Eigen::Vector4d(0, 0, 0, 1));
    transform.translate(numbers(node["translation"], Vec3(Vec3::Zero())));
    if (xyzw.norm() > 0)
      transform.rotate(Quat(xyzw.normalized()));
    else
      node["rotation"].fail("is zero");
    transform.scale(numbers(node["scale"], Vec3(Vec3::Ones())));
    return transform;
  }

  void read_mesh(std::size_t index, const Transform& world) {
    const JsonValue primitives = root_["meshes"][index]["primitives"];
    for (std::size_t k = 0; k < primitives.size() && !error_; ++k) read_primitive(primitives[k], world);
  }

  void read_primitive(const JsonValue& primitive, const Transform& world) {
    const auto mode = static_cast<int>(primitive["mode"].whole(triangles_mode, 6));
    if (mode < triangles_mode) {
      ++skipped_;
      return;
    }
    if (mode != triangles_mode)
      return primitive["mode"].fail("is a strip or a fan", "export plain triangles");
    if (use_ == MeshUse::texture && !primitive["attributes"]["TEXCOORD_0"])
      return primitive.fail("has no UVs (TEXCOORD_0)",
                            "a texture needs them; unwrap the mesh and export its UVs");
    const std::size_t first = mesh_.positions.size();
    read_vertices(primitive["attributes"], world);
    if (!error_) read_triangles(primitive, first, world.linear().determinant() < 0);
  }

  void read_vertices(const JsonValue& attributes, const Transform& world) {
    using Component = GltfBuffers::Component;
    const auto elements = [&](const char* attribute, const char* type, std::size_t components,
                              Component component) {
      return buffers_.elements(attributes[attribute].required_whole(max_list), type, components, component);
    };
    const Elements positions = elements("POSITION", "VEC3", 3, Component::floats);
    const bool has_uvs = static_cast<bool>(attributes["TEXCOORD_0"]);
    const Elements uvs = has_uvs ? elements("TEXCOORD_0", "VEC2", 2, Component::normalised) : Elements{};
    const bool has_normals = static_cast<bool>(attributes["NORMAL"]);
    const Elements normals = has_normals ? elements("NORMAL", "VEC3", 3, Component::floats) : Elements{};
    if (error_) return;
    if ((has_uvs && uvs.count != positions.count) || (has_normals && normals.count != positions.count))
      return attributes.fail("have different lengths");
    if (positions.count > max_mesh_vertices - mesh_.positions.size())
      return attributes.fail("make too many vertices", fmt::format("at most {} are read", max_mesh_vertices));
    const Mat3 normal_world = normal_transform(world.linear());
    const auto vector = [](const Elements& list, std::size_t k) {
      return Vec3(list.fraction(k, 0), list.fraction(k, 1), list.fraction(k, 2));
    };
    for (std::size_t k = 0; k < positions.count; ++k) {
      mesh_.positions.push_back(world * vector(positions, k));
      mesh_.normals.push_back(has_normals ? Vec3(normal_world * vector(normals, k)) : Vec3(Vec3::Zero()));
      // glTF counts v from the top row.
      mesh_.uvs.push_back(has_uvs ? Vec2(uvs.fraction(k, 0), 1 - uvs.fraction(k, 1)) : Vec2(Vec2::Zero()));
    }
  }

  // The inverse transpose up to a positive factor: the cofactors, which exist for flattening scales too.
  static Mat3 normal_transform(const Mat3& m) {
    Mat3 cofactors;
    cofactors << m.col(1).cross(m.col(2)), m.col(2).cross(m.col(0)), m.col(0).cross(m.col(1));
    const double largest = cofactors.cwiseAbs().maxCoeff();
    return largest > 0 ? Mat3(cofactors * (std::copysign(1.0, m.determinant()) / largest))
                       : Mat3(Mat3::Zero());
  }

  void read_triangles(const JsonValue& primitive, std::size_t first, bool mirrored) {
    const std::size_t vertices = mesh_.positions.size() - first;
    const JsonValue indices = primitive["indices"];
    Elements list;
    if (indices)
      list =
          buffers_.elements(indices.required_whole(max_list), "SCALAR", 1, GltfBuffers::Component::indices);
    if (error_) return;
    const std::size_t corners = indices ? list.count : vertices;
    if (corners % 3 != 0) return primitive.fail(fmt::format("has {} corners, not a multiple of 3", corners));
    if (corners / 3 > max_mesh_triangles - mesh_.triangles.size())
      return primitive.fail("makes too many triangles",
                            fmt::format("at most {} are read", max_mesh_triangles));
    for (std::size_t k = 0; k < corners; k += 3) {
      Triangle triangle;
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const std::size_t vertex = indices ? list.index(k + corner) : k + corner;
        if (vertex >= vertices)
          return primitive.fail(fmt::format("triangle {} names vertex {} of {}", k / 3, vertex, vertices));
        triangle[corner] = static_cast<int>(first + vertex);
      }
      if (mirrored) std::swap(triangle[1], triangle[2]);  // a mirroring transform turns triangles inside out
      mesh_.triangles.push_back(triangle);
    }
  }

  std::optional<Error> error_;
  JsonValue root_;
  GltfBuffers buffers_;
  std::string name_;
  MeshUse use_;
  std::vector<bool> visited_;
  std::size_t skipped_ = 0;
  TriangleMesh mesh_;
};

}  // namespace

Result<TriangleMesh> parse_gltf(std::span<const std::uint8_t> bytes, const std::string& name,
                                const SideBuffers& side_buffers, MeshUse use) {
  if (bytes.size() > max_mesh_file_bytes)
    return fail(name, fmt::format("has {} bytes", bytes.size()),
                fmt::format("at most {} are read", max_mesh_file_bytes));
  const auto chunks = split(bytes, name);
  if (!chunks) return tl::unexpected(chunks.error());
  const nlohmann::json json = parse_json(chunks->json);
  if (!json.is_object())
    return fail(name, "is not a glTF file: its JSON cannot be read", "is the file cut off?");
  return GltfReader(json, chunks->binary, name, side_buffers, use).read();
}

}  // namespace intaglio::surface
