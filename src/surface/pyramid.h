// A quadtree of bounds on the relief.
//
// A block of level 0 is 4 x 4 cells, that is, 5 x 5 texels; a block of level k + 1 is 2 x 2 blocks of level
// k. From level 1 on each block has a Range, the smallest and largest depth, exact because they are the
// texels' own floats. On slopes, boxes are loose: with boxes alone, doubling the resolution would double the
// number of blocks a nearest-point search opens. So blocks of every level also have a Slab: two parallel
// tilted planes that enclose the relief, and bounds on its slopes. The four children of a block are stored
// together (a quad), so that a descent loads one quad per level.
//
// Wrap: cells (i, j) for i in [0, width), one period. Clamp: i in [-1, width); the first and last columns
// also represent everything beyond the border, where the relief is constant across it. Rows likewise.
//
// Depths must be in 0..1. Immutable; any thread. Built in 2 ms at 512 x 512; 1 byte a texel (bench_surface).
//
// Source: Tevs, Ihrke and Seidel, "Maximum mipmaps for fast, accurate, and scalable dynamic height field
// rendering", 2008; the slabs are ours.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/huge_pages.h"
#include "surface/texels.h"

namespace intaglio::surface {

class Pyramid {
 public:
  static constexpr int leaf_cells = 4;  // cells a side of a block of level 0

  // Smallest and largest depth, fractions of max_depth.
  struct Range {
    double shallow, deep;
  };
  // With x and y in cells from the middle of the block (as if complete), depth is within [low, high] +
  // slope_x x + slope_y y. Over the block and the cells around it, slopes of the relief, per cell, differ
  // from these by `spread` at most.
  struct Slab {
    double slope_x, slope_y, spread_x, spread_y;
    double low, high;
  };

  Pyramid() = default;
  // `depth` as in Texels: row-major fractions; empty for none.
  Pyramid(std::span<const float> depth, const Grid& grid);

  int levels() const { return int(levels_.size()); }
  // Cells: index of the first, and their number along both axes.
  int first_cell() const { return first_; }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  // Whether block (x, y) of `level` exists. The root is a quad of blocks at levels() - 1, some of which may
  // be missing.
  bool exists(int level, int x, int y) const {
    return x * block_cells(level) < columns_ && y * block_cells(level) < rows_;
  }
  // Exact; for level 1 and up.
  Range range(int level, int x, int y) const {
    const std::size_t at = block(level, x, y);
    const Bounds4& quad = quads_[at / 4 - level_1_];
    return {quad.shallow[at % 4], quad.deep[at % 4]};
  }
  Slab slab(int level, int x, int y) const {
    const std::size_t at = block(level, x, y), k = at % 4;
    const Slabs4& s = slabs_[at / 4];
    return {s.slope_x[k] * slope_unit,    s.slope_y[k] * slope_unit, s.spread_x[k] * spread_unit_,
            s.spread_y[k] * spread_unit_, s.low[k] * depth_unit,     s.high[k] * depth_unit};
  }
  // The slabs of the four blocks of `level` in quad (x, y): slopes in slope_unit, low and high in depth_unit,
  // spreads in spread_unit().
  struct Slabs4 {
    std::array<std::int16_t, 4> slope_x, slope_y, low, high;
    std::array<std::uint8_t, 4> spread_x, spread_y;
  };
  static constexpr double slope_unit = 0x1.0p-15, depth_unit = 0x1.0p-14;
  double spread_unit() const { return spread_unit_; }
  const Slabs4& slabs(int level, int x, int y) const { return slabs_[block(level, 2 * x, 2 * y) / 4]; }
  // Bounds of the four blocks of `level` in quad (x, y), block k at (2x + (k & 1), 2y + (k >> 1)): their
  // ranges, or at level 0 the boxes around their slabs. Missing blocks have shallow > deep, both infinite.
  struct alignas(32) Bounds4 {
    std::array<float, 4> shallow, deep;
  };
  Bounds4 quad(int level, int x, int y) const {
    const std::size_t at = block(level, 2 * x, 2 * y);
    if (level > 0) return quads_[at / 4 - level_1_];
    Bounds4 out;
    const Slabs4& slabs = slabs_[at / 4];
    for (std::size_t k = 0; k < 4; ++k) {
      const double tilt =
          0.5 * leaf_cells * slope_unit * (std::abs(slabs.slope_x[k]) + std::abs(slabs.slope_y[k]));
      out.shallow[k] = float(slabs.low[k] * depth_unit - tilt);
      out.deep[k] = float(slabs.high[k] * depth_unit + tilt);
    }
    for (int k = 0; k < 4; ++k) {
      if (exists(0, 2 * x + (k & 1), 2 * y + (k >> 1))) continue;
      out.shallow[std::size_t(k)] = std::numeric_limits<float>::infinity();
      out.deep[std::size_t(k)] = -std::numeric_limits<float>::infinity();
    }
    return out;
  }
  // Prefetches the data that quad() reads.
  void prefetch_quad(int level, int x, int y) const {
    const std::size_t at = block(level, 2 * x, 2 * y);
    if (level > 0)
      __builtin_prefetch(&quads_[at / 4 - level_1_]);
    else
      __builtin_prefetch(&slabs_[at / 4]);
  }
  // Over the whole relief.
  Range total_range() const { return total_range_; }
  // Cells per side of a block of `level`.
  static int block_cells(int level) { return leaf_cells << level; }
  std::size_t memory_bytes() const {
    return quads_.capacity() * sizeof(Bounds4) + slabs_.capacity() * sizeof(Slabs4) +
           levels_.capacity() * sizeof(Level);
  }

 private:
  struct Level {
    std::size_t start;
    int width;  // both in quads
  };
  void build_leaves(std::span<const float> depth, const Grid& grid);
  void build_level(int level);
  Slab merge_children(int level, int x, int y) const;
  static double quantise_slope(double slope);
  // Rounds outwards.
  void store(const Slab& slab, std::size_t block);
  // Block k of a quad is at (2x + (k & 1), 2y + (k >> 1)).
  std::size_t block(int level, int x, int y) const {
    const Level& l = levels_[std::size_t(level)];
    const std::size_t quad = l.start + std::size_t(y >> 1) * std::size_t(l.width) + std::size_t(x >> 1);
    return 4 * quad + std::size_t((x & 1) | (y & 1) << 1);
  }

  int first_ = 0, columns_ = 0, rows_ = 0;
  double spread_unit_ = 0;
  Range total_range_{0, 0};
  std::size_t level_1_ = 0;  // quads of level 0, which have no ranges
  std::vector<Level> levels_;
  LargeArray<Bounds4> quads_;
  LargeArray<Slabs4> slabs_;
};

}  // namespace intaglio::surface
