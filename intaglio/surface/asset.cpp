#include "intaglio/surface/asset.h"

#include <cmath>

#include "intaglio/core/file.h"

namespace intaglio::surface {

namespace {

Image16 relief_image(const Texels& texels) {
  const bool depth = !texels.depth.empty();
  Image16 image(texels.width, texels.height, depth ? 4 : 3);
  for (int y = 0; y < texels.height; ++y) {
    for (int x = 0; x < texels.width; ++x) {
      const std::size_t k = std::size_t(texels.height - 1 - y) * std::size_t(texels.width) + std::size_t(x);
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) =
            static_cast<std::uint16_t>(std::lround((0.5 * texels.normal[k][c] + 0.5) * 65535));
      if (depth)
        image.at(x, y, 3) = static_cast<std::uint16_t>(
            std::lround(std::clamp(static_cast<double>(texels.depth[k]), 0.0, 1.0) * 65535));
    }
  }
  return image;
}

Image8 colour_image(const Image8& colour) {
  Image8 image(colour.width, colour.height, 3);
  for (int y = 0; y < colour.height; ++y) {
    for (int x = 0; x < colour.width; ++x) {
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = colour.at(x, colour.height - 1 - y, c);
    }
  }
  return image;
}

}  // namespace

Result<void> write_asset(const Imported& imported, const std::filesystem::path& folder) {
  if (auto written = write_file(folder / "relief.png", encode_png(relief_image(imported.texels))); !written)
    return written;
  return write_file(folder / "color.png", encode_png(colour_image(imported.texels.colour)));
}

}  // namespace intaglio::surface
