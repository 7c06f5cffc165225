// Binary data of a glTF file: buffers (the GLB chunk, data URIs, files beside it) and accessors into them,
// each checked against the bytes that are there. Source: glTF 2.0, Khronos, sections 3.6 and 4.4.
#pragma once

#include <cstring>
#include <span>

#include "mesh/gltf_json.h"
#include "mesh/mesh_file.h"

namespace intaglio::surface {

// The elements of an accessor; all are verified to lie inside the buffer.
struct Accessor {
  std::span<const std::uint8_t> bytes;  // from the first element
  std::size_t count = 0;
  std::size_t stride = 0;
  std::size_t component_bytes = 0;
  int component_type = 0;  // 5120 to 5126, as in the file

  // Component `c` of element `k`: floats unchanged, unsigned integers normalised to 0..1.
  double value(std::size_t k, std::size_t c) const;
  // Element `k` as an index; unsigned integers only.
  std::size_t index(std::size_t k) const;

 private:
  std::uint32_t unsigned_at(std::size_t k, std::size_t c) const;
};

class GltfBuffers {
 public:
  GltfBuffers(JsonValue root, std::span<const std::uint8_t> glb_chunk, BufferLoader load_buffer);

  // Allowed components of an accessor: floats; floats or normalised integers; unsigned integers.
  enum class Component { floats, normalised, indices };
  // Accessor `index`, which must be of `type` ("VEC3", 3 components). Empty on an error.
  Accessor accessor(std::size_t index, const char* type, std::size_t components, Component component);

 private:
  std::span<const std::uint8_t> buffer(std::size_t index);
  std::vector<std::uint8_t> load(const JsonValue& json);

  JsonValue root_;
  std::span<const std::uint8_t> glb_chunk_;
  BufferLoader load_buffer_;
  std::vector<std::optional<std::vector<std::uint8_t>>> loaded_;
  std::size_t loaded_bytes_ = 0;
};

}  // namespace intaglio::surface
