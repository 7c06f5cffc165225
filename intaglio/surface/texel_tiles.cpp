#include "intaglio/surface/texel_tiles.h"

namespace intaglio::surface {

TexelTiles::TexelTiles(const Grid& grid, std::span<const float> depth, std::span<const PackedNormal> normal)
    : grid_(grid) {
  const auto across = static_cast<std::size_t>((grid.width + side - 1) / side),
             along = static_cast<std::size_t>((grid.height + side - 1) / side);
  stride_ = across * texels;
  depth_.resize(stride_ * along);
  normal_.resize(stride_ * along);
  std::size_t from = 0;
  for (int j = 0; j < grid.height; ++j) {
    for (int i = 0; i < grid.width; ++i, ++from) {
      const std::size_t to = index(i, j);
      if (!depth.empty()) depth_[to] = depth[from];
      normal_[to] = normal[from];
    }
  }
}

}  // namespace intaglio::surface
