#include "mesh/gltf_file.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

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

std::uint32_t Accessor::unsigned_at(std::size_t k, std::size_t c) const {
  std::uint32_t value = 0;
  for (std::size_t byte = 0; byte < component_bytes; ++byte)  // little-endian, whatever the machine
    value |= std::uint32_t(bytes[k * stride + c * component_bytes + byte]) << (8 * byte);
  return value;
}

double Accessor::value(std::size_t k, std::size_t c) const {
  const std::uint32_t bits = unsigned_at(k, c);
  if (component_type == unsigned_byte) return bits / 255.0;
  if (component_type == unsigned_short) return bits / 65535.0;
  float value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return double(value);
}

std::size_t Accessor::index(std::size_t k) const {
  return unsigned_at(k, 0);
}

GltfBuffers::GltfBuffers(JsonValue root, std::span<const std::uint8_t> glb_chunk, BufferLoader load_buffer)
    : root_(std::move(root)),
      glb_chunk_(glb_chunk),
      load_buffer_(std::move(load_buffer)),
      loaded_(root_["buffers"].size()) {}

std::vector<std::uint8_t> GltfBuffers::load(const JsonValue& json) {
  const JsonValue uri = json["uri"];
  const std::string text = uri.string();
  if (auto bytes = data_uri(text)) return std::move(*bytes);
  const auto name = relative_file(text);
  if (!name) {
    uri.fail("is " + printable(text), "use embedded base64 data or a file in the same folder");
    return {};
  }
  if (!load_buffer_) {
    uri.fail("refers to an external file", "only embedded buffers can be read from memory");
    return {};
  }
  auto bytes = load_buffer_(*name, max_mesh_file_bytes - loaded_bytes_);
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
  const std::size_t length = json["byteLength"].required_integer(max_mesh_file_bytes);
  if (length > bytes.size()) {
    json.fail(fmt::format("declares {} bytes but has {}", length, bytes.size()), "is the file cut off?");
    return {};
  }
  return bytes.first(length);
}

Accessor GltfBuffers::accessor(std::size_t index, const char* type, std::size_t components,
                               Component component) {
  const JsonValue json = root_["accessors"][index];
  if (!json) return {};
  if (json["sparse"] || !json["bufferView"]) {
    json.fail("is sparse or has no data", "export without sparse accessors");
    return {};
  }
  Accessor accessor;
  accessor.component_type = int(json["componentType"].required_integer(65535));
  accessor.component_bytes = bytes_of(accessor.component_type);
  if (json["type"].string() != type ||
      !allowed(component, accessor.component_type, json["normalized"].boolean(false))) {
    json.fail("has the wrong type for its use", fmt::format("{} of a type that glTF 2.0 allows there", type));
    return {};
  }
  const JsonValue view = root_["bufferViews"][json["bufferView"].required_integer(max_mesh_file_bytes)];
  if (!view) return {};
  const auto bytes = buffer(view["buffer"].required_integer(max_mesh_file_bytes));
  const std::size_t begin = view["byteOffset"].integer(0, max_mesh_file_bytes);
  const std::size_t length = view["byteLength"].required_integer(max_mesh_file_bytes);
  const std::size_t offset = json["byteOffset"].integer(0, max_mesh_file_bytes);
  const std::size_t element = components * accessor.component_bytes;
  accessor.stride = view["byteStride"].integer(element, max_stride);
  accessor.count = json["count"].required_integer(max_mesh_file_bytes);
  // All of these are at most 2^28 and the stride at most 252: no sum or product below overflows 64 bits.
  if (begin + length > bytes.size()) {
    view.fail(fmt::format("ends at byte {} of a buffer of {}", begin + length, bytes.size()));
    return {};
  }
  if (accessor.stride < element || accessor.count == 0 ||
      offset + (accessor.count - 1) * accessor.stride + element > length) {
    json.fail(
        fmt::format("needs {} elements, more than fit its buffer view of {} bytes", accessor.count, length));
    return {};
  }
  accessor.bytes = bytes.subspan(begin + offset, length - offset);
  return accessor;
}

// glTF 2.0: the container, the scene's nodes, and the triangles of their meshes.

namespace {

using Transform = Eigen::Affine3d;

constexpr std::size_t max_index = max_mesh_file_bytes;  // no index can be larger than the file
constexpr int max_node_depth = 64;
constexpr int triangles_mode = 4;

struct GlbChunks {
  std::span<const std::uint8_t> json, binary;
};

std::uint32_t little_endian(std::span<const std::uint8_t> bytes, std::size_t at) {
  return bytes[at] | std::uint32_t(bytes[at + 1]) << 8 | std::uint32_t(bytes[at + 2]) << 16 |
         std::uint32_t(bytes[at + 3]) << 24;
}

// A GLB is a header of 12 bytes, then chunks of length, type, bytes: first JSON, then perhaps BIN.
Result<GlbChunks> split_glb(std::span<const std::uint8_t> bytes, const std::string& name) {
  constexpr std::uint32_t glb_magic = 0x46546c67, json_type = 0x4e4f534a, binary_type = 0x004e4942;
  if (bytes.size() < 4 || little_endian(bytes, 0) != glb_magic) return GlbChunks{bytes, {}};
  if (bytes.size() < 20) return fail(name, "is truncated inside its GLB header", "is the file cut off?");
  if (little_endian(bytes, 4) != 2)
    return fail(name, fmt::format("is GLB version {}", little_endian(bytes, 4)),
                "only version 2 is supported");
  if (little_endian(bytes, 8) > bytes.size())
    return fail(name, fmt::format("declares {} bytes but has {}", little_endian(bytes, 8), bytes.size()),
                "is the file cut off?");
  GlbChunks chunks;
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

// How large the JSON of a file would be when parsed, and how deeply it nests, by its punctuation alone.
struct JsonExtent {
  std::size_t values = 0;  // about: every value but the first follows one of { [ , :
  int depth = 0;
};

JsonExtent extent_of(std::span<const std::uint8_t> text) {
  JsonExtent extent;
  int depth = 0;
  bool in_string = false;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const auto c = char(text[k]);
    if (in_string && c == '\\') ++k;  // skips an escaped quote
    if (c == '"') in_string = !in_string;
    if (in_string) continue;
    if (c == '{' || c == '[') extent.depth = std::max(extent.depth, ++depth);
    if (c == '}' || c == ']') --depth;
    if (c == '{' || c == '[' || c == ',' || c == ':') ++extent.values;
  }
  return extent;
}

// The JSON of the file, without exceptions. The parser's own callback, which could bound the nesting, makes
// it quadratic in the number of nodes: after each one it searches its siblings for discarded values.
Result<nlohmann::json> parse_json(std::span<const std::uint8_t> text, const std::string& name,
                                  std::uint64_t allowed_memory) {
  constexpr int max_json_depth = 100;
  constexpr double bytes_per_value = 80;  // of nlohmann::json, with the key of a member
  const JsonExtent extent = extent_of(text);
  const MemoryCost cost("JSON", double(text.size()) + bytes_per_value * double(extent.values));
  if (auto fits = check_memory(name, cost, allowed_memory); !fits) return tl::unexpected(fits.error());
  nlohmann::json json;
  if (extent.depth <= max_json_depth) json = nlohmann::json::parse(text.begin(), text.end(), nullptr, false);
  if (json.is_object()) return json;
  return fail(name, "is not a glTF file: its JSON cannot be read", "is the file cut off?");
}

class GltfReader {
 public:
  GltfReader(const nlohmann::json& json, std::span<const std::uint8_t> binary, const std::string& name,
             const BufferLoader& load_buffer, const MeshOptions& options)
      : file_{name, {}}, root_(&json, "", file_), buffers_(root_, binary, load_buffer), options_(options) {}

  Result<TriangleMesh> read() {
    check_asset();
    const JsonValue scenes = root_["scenes"];
    visited_.assign(root_["nodes"].size(), false);
    if (scenes.size() > 0) {
      const JsonValue roots = scenes[root_["scene"].integer(0, max_index)]["nodes"];
      for (std::size_t k = 0; k < roots.size() && !file_.error; ++k)
        read_node(roots[k].required_integer(max_index), Transform::Identity(), 0);
    } else {
      for (std::size_t k = 0; k < root_["meshes"].size() && !file_.error; ++k)
        read_mesh(k, Transform::Identity());
    }
    if (file_.error) return tl::unexpected(*file_.error);
    if (skipped_ > 0)
      mesh_.notes.push_back(fmt::format("{} primitives of points or lines were skipped", skipped_));
    return checked(std::move(mesh_), file_.name);
  }

 private:
  void check_asset() {
    if (!root_["asset"]["version"].string().starts_with("2"))
      root_["asset"].fail("is not glTF 2", "only version 2.0 is supported");
    const JsonValue required = root_["extensionsRequired"];
    for (std::size_t k = 0; k < required.size() && !file_.error; ++k) {
      const std::string extension = required[k].string();
      const auto appearance_only = {"KHR_materials_", "KHR_lights_", "KHR_texture_basisu",
                                    "EXT_texture_webp"};
      if (std::none_of(appearance_only.begin(), appearance_only.end(),
                       [&](const char* prefix) { return extension.starts_with(prefix); }))
        required[k].fail("requires " + printable(extension) + ", which is not supported",
                         "export without it");
    }
  }

  // A node may be reached only once, which makes the nodes a tree and a cycle an error.
  void read_node(std::size_t index, const Transform& parent, int depth) {
    const JsonValue node = root_["nodes"][index];
    if (!node || file_.error) return;
    if (visited_[index] || depth > max_node_depth)
      return node.fail("is part of a cycle, has two parents, or is nested too deeply");
    visited_[index] = true;
    const Transform world = parent * local_transform(node);
    if (node["mesh"]) read_mesh(node["mesh"].required_integer(max_index), world);
    const JsonValue children = node["children"];
    for (std::size_t k = 0; k < children.size() && !file_.error; ++k)
      read_node(children[k].required_integer(max_index), world, depth + 1);
  }

  static Transform local_transform(const JsonValue& node) {
    Transform transform = Transform::Identity();
    if (const JsonValue matrix = node["matrix"]) {
      for (int k = 0; k < 16; ++k) {
        const double value = matrix[std::size_t(k)].number(0);
        if (k % 4 < 3) transform.matrix()(k % 4, k / 4) = value;
      }
      return transform;
    }
    const auto numbers = [](const JsonValue& list, auto fallback) {
      if (!list) return fallback;
      for (Eigen::Index k = 0; k < fallback.size(); ++k) fallback[k] = list[std::size_t(k)].number(0);
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
    for (std::size_t k = 0; k < primitives.size() && !file_.error; ++k) read_primitive(primitives[k], world);
  }

  void read_primitive(const JsonValue& primitive, const Transform& world) {
    const auto mode = int(primitive["mode"].integer(triangles_mode, 6));
    if (mode < triangles_mode) {
      ++skipped_;
      return;
    }
    if (mode != triangles_mode)
      return primitive["mode"].fail("is a strip or a fan", "export plain triangles");
    if (options_.use == MeshUse::texture && !primitive["attributes"]["TEXCOORD_0"])
      return primitive.fail("has no UVs (TEXCOORD_0)",
                            "a texture needs them; unwrap the mesh and export its UVs");
    const std::size_t first = mesh_.positions.size();
    read_vertices(primitive["attributes"], world);
    if (!file_.error) read_triangles(primitive, first, world.linear().determinant() < 0);
  }

  void read_vertices(const JsonValue& attributes, const Transform& world) {
    using Component = GltfBuffers::Component;
    const auto accessor = [&](const char* attribute, const char* type, std::size_t components,
                              Component component) {
      return buffers_.accessor(attributes[attribute].required_integer(max_index), type, components,
                               component);
    };
    const Accessor positions = accessor("POSITION", "VEC3", 3, Component::floats);
    const bool has_uvs = bool(attributes["TEXCOORD_0"]);
    const Accessor uvs = has_uvs ? accessor("TEXCOORD_0", "VEC2", 2, Component::normalised) : Accessor{};
    const bool has_normals = bool(attributes["NORMAL"]);
    const Accessor normals = has_normals ? accessor("NORMAL", "VEC3", 3, Component::floats) : Accessor{};
    if (file_.error) return;
    if ((has_uvs && uvs.count != positions.count) || (has_normals && normals.count != positions.count))
      return attributes.fail("have different counts");
    if (positions.count > max_mesh_vertices - mesh_.positions.size())
      return attributes.fail("have too many vertices", fmt::format("at most {} are read", max_mesh_vertices));
    const std::size_t vertices = mesh_.positions.size() + positions.count;
    if (auto fits = check_mesh_memory(file_.name, vertices, vertices, options_.allowed_memory); !fits) {
      file_.error = fits.error();
      return;
    }
    const Mat3 normal_world = normal_transform(world.linear());
    const auto vector = [](const Accessor& list, std::size_t k) {
      return Vec3(list.value(k, 0), list.value(k, 1), list.value(k, 2));
    };
    for (std::size_t k = 0; k < positions.count; ++k) {
      mesh_.positions.push_back(world * vector(positions, k));
      mesh_.normals.push_back(has_normals ? Vec3(normal_world * vector(normals, k)) : Vec3(Vec3::Zero()));
      // glTF counts v from the top row.
      mesh_.uvs.push_back(has_uvs ? Vec2(uvs.value(k, 0), 1 - uvs.value(k, 1)) : Vec2(Vec2::Zero()));
    }
  }

  // The inverse transpose up to a positive factor: the cofactors, defined also for a singular scale.
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
    Accessor list;
    if (indices)
      list = buffers_.accessor(indices.required_integer(max_index), "SCALAR", 1,
                               GltfBuffers::Component::indices);
    if (file_.error) return;
    const std::size_t corners = indices ? list.count : vertices;
    if (corners % 3 != 0) return primitive.fail(fmt::format("has {} corners, not a multiple of 3", corners));
    if (corners / 3 > max_mesh_triangles - mesh_.triangles.size())
      return primitive.fail("has too many triangles", fmt::format("at most {} are read", max_mesh_triangles));
    for (std::size_t k = 0; k < corners; k += 3) {
      Triangle triangle;
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const std::size_t vertex = indices ? list.index(k + corner) : k + corner;
        if (vertex >= vertices)
          return primitive.fail(fmt::format("triangle {} uses vertex {} of {}", k / 3, vertex, vertices));
        triangle[corner] = int(first + vertex);
      }
      if (mirrored) std::swap(triangle[1], triangle[2]);  // a mirroring transform turns triangles inside out
      mesh_.triangles.push_back(triangle);
    }
  }

  JsonValue::File file_;
  JsonValue root_;
  GltfBuffers buffers_;
  MeshOptions options_;
  std::vector<bool> visited_;
  std::size_t skipped_ = 0;
  TriangleMesh mesh_;
};

}  // namespace

Result<TriangleMesh> parse_gltf(std::span<const std::uint8_t> bytes, const std::string& name,
                                const BufferLoader& load_buffer, const MeshOptions& options) {
  if (auto size = check_mesh_file_size(bytes.size(), name); !size) return tl::unexpected(size.error());
  const auto chunks = split_glb(bytes, name);
  if (!chunks) return tl::unexpected(chunks.error());
  const auto json = parse_json(chunks->json, name, options.allowed_memory);
  if (!json) return tl::unexpected(json.error());
  return GltfReader(*json, chunks->binary, name, load_buffer, options).read();
}

}  // namespace intaglio::surface
