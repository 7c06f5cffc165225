// Mip levels of a surface: mean depth, mean slope, and the roughness that averaging hid.
//
// Level 0 is the surface's own texels; level k + 1 has ceil(n / 2) texels a side and is the area-weighted
// mean of level k, so that means are kept exactly at every size, powers of two or not, and the grid closes
// seamlessly under wrap. Slope is (dz/dx, dz/dy) of the height as the normal tells it, -n_xy / n_z.
// E[slope^2] over a level is the same at every level: what leaves the mean slope goes to `variance` (Toksvig
// 2005; Olano and Baker, "LEAN mapping", 2010). Storage: 8 bytes a texel, a third as many texels as level 0.
// Steps: depth 1/65535; slope and root of variance 1/32767 and 1/65535 of the steepest slope of the map.
// Immutable; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "intaglio/core/huge_pages.h"
#include "intaglio/core/vec.h"
#include "intaglio/surface/mip_grid.h"
#include "intaglio/surface/packed_normal.h"

namespace intaglio::surface {

// A slope is limited to this length (87 degrees): one normal in the plane would otherwise drown every mean.
inline constexpr double steepest_slope = 20;

// Slope of a unit normal, limited to steepest_slope.
Vec2 slope_of(const Vec3& normal);

class Mips {
 public:
  struct Moments {
    double depth;      // fraction of max_depth
    Vec2 depth_slope;  // its derivative per texel of the level, of the bilinear patch (0 from `texel`)
    Vec2 slope;        // mean
    double variance;   // E[|slope|^2] - |E[slope]|^2
  };

  // Which levels a footprint falls between: (1 - next) of `level` and `next` of level + 1.
  struct Blend {
    int level;
    double next;
  };

  Mips() = default;
  // `depth` may be empty (then 0); `normal` has grid.size() elements.
  Mips(const Grid& grid, std::span<const float> depth, std::span<const PackedNormal> normal);

  // The coarsest level, of 1 x 1 texel; 0 when level 0 is that already. Levels 1..top() are stored here.
  int top() const { return static_cast<int>(levels_.size()); }
  const Grid& grid(int level) const { return levels_[static_cast<std::size_t>(level - 1)].grid; }
  Moments texel(int level, int i, int j) const;
  // Bilinear over the level at uv.
  Moments bilinear(int level, const Vec2& uv) const;
  // Mean depth fraction of stored texel k of the level, for interpolation of one's own.
  double depth(int level, std::size_t k) const {
    return texels_[levels_[static_cast<std::size_t>(level - 1)].start + k].depth / 65535.0;
  }
  // Footprint in texels of level 0: 1 or less is level 0, 2^k is level k, linear between.
  Blend blend(double footprint) const;
  std::size_t memory_bytes() const {
    return texels_.capacity() * sizeof(Texel) + levels_.capacity() * sizeof(Level);
  }

 private:
  struct Texel {
    std::uint16_t depth;
    std::int16_t slope_x, slope_y;
    std::uint16_t roughness;  // root of the variance
  };
  struct Level {
    Grid grid;
    std::size_t start;
  };

  Moments unpack(const Texel& texel) const;

  double scale_ = 0;  // steepest slope of level 0
  std::vector<Level> levels_;
  LargeArray<Texel> texels_;
};

}  // namespace intaglio::surface
