// The texels of a surface as queries want them: four by four, so that neighbours share cache lines.
//
// A line holds a tile of 16 depths, or of 16 normals. A cell's four corners are in 1.6 tiles on average where
// rows would cost 2.1 lines on 2 pages, a block of the pyramid (4 x 4 cells) in four tiles where rows would
// cost 6 lines on 5 pages. Immutable; any thread.
#pragma once

#include <span>

#include "intaglio/core/huge_pages.h"
#include "intaglio/surface/mip_grid.h"
#include "intaglio/surface/packed_normal.h"

namespace intaglio::surface {

class TexelTiles {
 public:
  static constexpr int side = 4;

  TexelTiles() = default;
  // Row-major texels, as in Texels; without `depth` (empty) it is 0 everywhere.
  TexelTiles(const Grid& grid, std::span<const float> depth, std::span<const PackedNormal> normal);

  // Texel (i, j) is number row(j) + column(i); i, j any integer, wrapped or clamped.
  std::size_t index(int i, int j) const { return row(j) + column(i); }
  std::size_t column(int i) const {
    const auto k = static_cast<std::size_t>(grid_.within(i, grid_.width));
    return k + k / side * (texels - side);
  }
  std::size_t row(int j) const {
    const auto k = static_cast<std::size_t>(grid_.within(j, grid_.height));
    return k / side * stride_ + k % side * side;
  }

  float depth(std::size_t index) const { return depth_[index]; }
  const PackedNormal& normal(std::size_t index) const { return normal_[index]; }
  // Asks the cache for the depths of the tile of a texel.
  void prefetch_depth(std::size_t index) const { __builtin_prefetch(depth_.data() + index); }

  std::size_t memory_bytes() const { return depth_.size() * (sizeof(float) + sizeof(PackedNormal)); }

 private:
  static constexpr std::size_t texels = side * side;

  Grid grid_;
  std::size_t stride_ = 0;  // texels in a row of tiles
  LargeArray<float> depth_;
  LargeArray<PackedNormal> normal_;
};

}  // namespace intaglio::surface
