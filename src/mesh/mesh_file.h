// Mesh files: Wavefront OBJ (.obj), glTF 2.0 (.gltf with embedded or side buffers, .glb) and, for their shape
// only, STL (.stl, binary or ASCII), from untrusted sources.
//
// Reads triangles (OBJ: polygons, cut into fans), positions, normals, UVs; glTF node transforms are applied
// and v is flipped where needed so that v = 0 is the bottom row. Materials, images, skins and animations are
// ignored. Units are taken as metres. Missing normals are computed, missing UVs are an error unless only the
// shape is wanted. Limits: a file with its side files 256 MB, 4 million triangles, the memory that is allowed
// (docs/trust.md, Budgets); every count is checked against the bytes that are there before memory is
// allocated. Side buffers must lie in the mesh's own folder
// or below. Errors name the file, the place in it and what is wrong, on one line. Cost: about 2 s a million
// triangles.
//
// Both parsers are our own: tinyobjloader reads malformed numbers as 0, tinygltf recurses without limit, and
// both leave indices unchecked.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/budget.h"
#include "mesh/triangle_mesh.h"

namespace intaglio::surface {

inline constexpr std::size_t max_mesh_file_bytes = 256u << 20;
// An error when a file has more bytes.
Result<void> check_mesh_file_size(std::size_t bytes, const std::string& name);

// The use of a mesh: to lay a texture on it, or for its shape alone, where missing UVs are zero.
enum class MeshUse { texture, shape };

struct MeshOptions {
  MeshUse use = MeshUse::texture;
  std::uint64_t allowed_memory = default_allowed_memory;  // bytes; a file that needs more is refused

  MeshOptions() = default;
  MeshOptions(MeshUse wanted, std::uint64_t allowed = default_allowed_memory)
      : use(wanted), allowed_memory(allowed) {}
};

// The mesh of a file, checked (triangle_mesh.h). The format is chosen by the extension.
Result<TriangleMesh> read_mesh(const std::filesystem::path& path, const MeshOptions& options = {});

// The same from memory; `name` is for errors.
Result<TriangleMesh> parse_obj(std::string_view text, const std::string& name,
                               const MeshOptions& options = {});

// Returns the bytes of a side buffer given its (decoded, relative) uri, at most `limit`.
using BufferLoader =
    std::function<Result<std::vector<std::uint8_t>>(const std::string& uri, std::size_t limit)>;
// .gltf or .glb, distinguished by its first bytes. Without `load_buffer` a file that needs a side buffer is
// an error.
Result<TriangleMesh> parse_gltf(std::span<const std::uint8_t> bytes, const std::string& name,
                                const BufferLoader& load_buffer = {}, const MeshOptions& options = {});
// STL, binary when its length is what its count of triangles says, else ASCII. UVs are zero; the facets' own
// normals are ignored, since many exporters leave them zero.
Result<TriangleMesh> parse_stl(std::span<const std::uint8_t> bytes, const std::string& name,
                               const MeshOptions& options = {});

// Whether reading so many vertices, as stored, and triangles keeps the budget.
Result<void> check_mesh_memory(const std::string& name, std::size_t vertices, std::size_t triangles,
                               std::uint64_t allowed);

}  // namespace intaglio::surface
