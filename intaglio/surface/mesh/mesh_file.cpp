#include "intaglio/surface/mesh/mesh_file.h"

#include <algorithm>
#include <cctype>

#include "intaglio/core/file.h"

namespace intaglio::surface {

namespace fs = std::filesystem;

namespace {

// Links are followed before the comparison: one that leads out of the folder is as good as "..".
bool lies_within(const fs::path& folder, const fs::path& path) {
  std::error_code error;
  const fs::path inner = fs::weakly_canonical(path, error);
  if (error) return false;
  const fs::path outer = fs::canonical(folder, error);
  if (error) return false;
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

SideBuffers buffers_beside(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  return [folder, name = path.string()](const std::string& uri,
                                        std::size_t limit) -> Result<std::vector<std::uint8_t>> {
    const fs::path side = folder / uri;
    if (fs::path(uri).is_absolute() || !lies_within(folder, side))
      return fail(name, "names the buffer " + uri + ", outside its own folder",
                  "buffers must lie beside the file");
    return read_file(side, limit);
  };
}

}  // namespace

Result<TriangleMesh> read_mesh(const fs::path& path, MeshUse use) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  const bool gltf = extension == ".gltf" || extension == ".glb";
  const bool stl = extension == ".stl";
  if (!gltf && !stl && extension != ".obj")
    return fail(path.string(), "is not a mesh file that can be read",
                use == MeshUse::shape ? "use .obj, .stl, .gltf or .glb" : "use .obj, .gltf or .glb");
  if (stl && use == MeshUse::texture)
    return fail(path.string(), "is an STL file, which has no UVs",
                "a texture needs them; use .obj, .gltf or .glb");
  const auto bytes = read_file(path, max_mesh_file_bytes);
  if (!bytes) return tl::unexpected(bytes.error());
  if (gltf) return parse_gltf(*bytes, path.string(), buffers_beside(path), use);
  if (stl) return parse_stl(*bytes, path.string());
  return parse_obj({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, path.string(), use);
}

}  // namespace intaglio::surface
