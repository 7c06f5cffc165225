#include "intaglio/surface/mesh/gltf_buffers.h"

#include "intaglio/surface/mesh/uri.h"

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

}  // namespace intaglio::surface
