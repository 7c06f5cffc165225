// Which image of a texture is what, by the names that artists and libraries give them.
#pragma once

#include <filesystem>

#include "intaglio/core/error.h"

namespace intaglio::surface {

// Any of the three may be empty, but not both of the first.
struct TextureFiles {
  std::filesystem::path normal, height, colour;
};

// `path` is a folder, searched by the usual names (nor_gl, NormalDX, disp, height, diff, Color, ...; an image
// whose name claims no role is the colour map), or one image. That image is then in `normal`, whatever it is:
// the caller decides by its pixels. The height and colour maps that lie beside it under the same name are
// found as well.
Result<TextureFiles> find_texture_files(const std::filesystem::path& path);

// Whether a normal map's name says that its green channel is -Y (DirectX).
bool named_directx(const std::filesystem::path& path);

}  // namespace intaglio::surface
