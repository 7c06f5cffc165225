#include "intaglio/render/shader_files.h"

#include "intaglio/core/file.h"
#include "intaglio_shaders.h"

namespace intaglio::render {

ShaderFiles embedded_shaders() {
  ShaderFiles out;
  for (const auto& [name, text] : embedded_shader_files) out[name] = text;
  return out;
}

Result<ShaderFiles> shaders_from(const std::filesystem::path& folder) {
  ShaderFiles out = embedded_shaders();
  int found = 0;
  for (auto& [name, text] : out) {
    std::error_code missing;
    if (!std::filesystem::is_regular_file(folder / name, missing)) continue;
    const auto bytes = read_file(folder / name);
    if (!bytes) return tl::unexpected(bytes.error());
    text.assign(bytes->begin(), bytes->end());
    ++found;
  }
  if (found == 0)
    return fail(folder.string(), "has none of the shaders",
                "they are named as in intaglio/render/shaders, like slab.frag");
  return out;
}

}  // namespace intaglio::render
