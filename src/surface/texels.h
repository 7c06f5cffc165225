// The texels of a surface: how they are indexed, packed, stored, interpolated and averaged into mip levels.
//
// Texel centres are at integer coordinates; row 0 is v = 0. Immutable or pure; any thread; no query
// allocates.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/huge_pages.h"
#include "intaglio/vec.h"

namespace intaglio::surface {

enum class Edge { wrap, clamp };

// --- Indices ---

// The texels of one mip level, row-major: how indices beyond the border are mapped.
struct Grid {
  int width = 0;
  int height = 0;
  Edge edge = Edge::wrap;

  std::size_t size() const { return std::size_t(width) * std::size_t(height); }
  // Where texel (i, j) is stored; i, j any integer.
  std::size_t index(int i, int j) const { return row(j) + column(i); }
  std::size_t column(int i) const { return std::size_t(wrap_or_clamp(i, width)); }
  std::size_t row(int j) const { return std::size_t(wrap_or_clamp(j, height)) * std::size_t(width); }
  int wrap_or_clamp(int i, int n) const {
    if (unsigned(i) < unsigned(n)) return i;
    if (edge == Edge::clamp) return i < 0 ? 0 : n - 1;
    const int m = i % n;
    return m < 0 ? m + n : m;
  }
};

// A texel coordinate as the index of its cell and the position in it, 0..1. NaN is treated as far outside.
struct TexelCoordinate {
  int index;
  double fraction;

  explicit TexelCoordinate(double coordinate) {
    // So that the index fits an int; queries that far away need no more precision.
    const double bounded = coordinate > -1e9 ? std::min(coordinate, 1e9) : -1e9;
    const double floor = std::floor(bounded);
    index = int(floor);
    fraction = bounded - floor;
  }
};

// --- Storage ---

// A unit normal, n_z >= 0, in 4 bytes.
struct PackedNormal {
  std::int16_t x, y;  // times 32767

  static PackedNormal pack(const Vec3& normal);
  Vec3 unit() const {
    const double nx = x / 32767.0;
    const double ny = y / 32767.0;
    return {nx, ny, std::sqrt(std::max(0.0, 1.0 - nx * nx - ny * ny))};
  }
};

// A component of a unit vector as a sample of a 16-bit normal map.
inline std::uint16_t encode_component(double n) {
  return std::uint16_t(std::lround((0.5 * n + 0.5) * 65535));
}

// Texels stored in 4 x 4 tiles, so that neighbours share cache lines.
//
// A cache line holds a tile of 16 depths, or of 16 normals. The four corners of a cell lie in 1.6 tiles on
// average, where rows would cost 2.1 lines on 2 pages; a block of the pyramid (4 x 4 cells) lies in four
// tiles, where rows would cost 6 lines on 5 pages.
class TexelTiles {
 public:
  static constexpr int side = 4;

  TexelTiles() = default;
  // Row-major texels, as in Texels; an empty `depth` is 0 everywhere.
  TexelTiles(const Grid& grid, std::span<const float> depth, std::span<const PackedNormal> normal);

  // Where texel (i, j) is stored: row(j) + column(i); i, j any integer, wrapped or clamped.
  std::size_t index(int i, int j) const { return row(j) + column(i); }
  std::size_t column(int i) const {
    const auto k = std::size_t(grid_.wrap_or_clamp(i, grid_.width));
    return k + k / side * (tile_texels - side);
  }
  std::size_t row(int j) const {
    const auto k = std::size_t(grid_.wrap_or_clamp(j, grid_.height));
    return k / side * stride_ + k % side * side;
  }

  float depth(std::size_t index) const { return depth_[index]; }
  const PackedNormal& normal(std::size_t index) const { return normal_[index]; }
  // Prefetches the depth tile of a texel.
  void prefetch_depth(std::size_t index) const { __builtin_prefetch(depth_.data() + index); }

  std::size_t memory_bytes() const { return depth_.size() * (sizeof(float) + sizeof(PackedNormal)); }

 private:
  static constexpr std::size_t tile_texels = side * side;

  Grid grid_;
  std::size_t stride_ = 0;  // texels in a row of tiles
  LargeArray<float> depth_;
  LargeArray<PackedNormal> normal_;
};

// --- Interpolation ---
//
// Bilinear (the relief itself) and Catmull-Rom bicubic (C1, for forces). A layout (Grid, TexelTiles) stores
// texel (i, j) at row(j) + column(i); `fetch(k)` returns the value stored at k. Derivatives are per texel.
// Source: Catmull and Rom, "A class of local interpolating splines", 1974.

struct Interpolated {
  double value, d_x, d_y;
};

// The 2 x 2 texels around a coordinate (in texels, texel centres at integers), rows one after the other.
struct BilinearTaps {
  std::array<std::size_t, 4> index;
  double x, y;  // position between them, 0..1

  template <class Layout>
  BilinearTaps(const Layout& layout, double coordinate_x, double coordinate_y) {
    const TexelCoordinate sx(coordinate_x), sy(coordinate_y);
    const std::size_t left = layout.column(sx.index), right = layout.column(sx.index + 1);
    const std::size_t low = layout.row(sy.index), high = layout.row(sy.index + 1);
    index = {low + left, low + right, high + left, high + right};
    x = sx.fraction;
    y = sy.fraction;
  }
  std::array<double, 4> weights() const { return {(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y}; }

  template <class Fetch>
  Interpolated operator()(const Fetch& fetch) const {
    const double a = fetch(index[0]), b = fetch(index[1]), c = fetch(index[2]), d = fetch(index[3]);
    const double low = a + x * (b - a), high = c + x * (d - c);
    return {low + y * (high - low), (b - a) + y * (d - c - b + a), high - low};
  }
};

// Weights of four neighbours at position f in 0..1 between the middle two, and their derivatives.
struct CatmullRom {
  std::array<double, 4> weight, slope;

  explicit CatmullRom(double f) {
    const double f2 = f * f, f3 = f2 * f;
    weight = {-0.5 * f + f2 - 0.5 * f3, 1 - 2.5 * f2 + 1.5 * f3, 0.5 * f + 2 * f2 - 1.5 * f3,
              -0.5 * f2 + 0.5 * f3};
    slope = {-0.5 + 2 * f - 1.5 * f2, -5 * f + 4.5 * f2, 0.5 + 4 * f - 4.5 * f2, -f + 1.5 * f2};
  }
};

template <class Layout, class Fetch>
Interpolated bicubic(const Layout& layout, double coordinate_x, double coordinate_y, const Fetch& fetch) {
  const TexelCoordinate sx(coordinate_x), sy(coordinate_y);
  const CatmullRom cx(sx.fraction), cy(sy.fraction);
  std::array<std::size_t, 4> column;
  for (int k = 0; k < 4; ++k) column[std::size_t(k)] = layout.column(sx.index - 1 + k);
  Interpolated sum{0, 0, 0};
  for (std::size_t r = 0; r < 4; ++r) {
    const std::size_t row = layout.row(sy.index - 1 + int(r));
    double value = 0, slope = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const double texel = fetch(row + column[k]);
      value += cx.weight[k] * texel;
      slope += cx.slope[k] * texel;
    }
    sum.value += cy.weight[r] * value;
    sum.d_x += cy.weight[r] * slope;
    sum.d_y += cy.slope[r] * value;
  }
  return sum;
}

// --- Averages ---

// Slopes are limited to this length (87 degrees): otherwise one horizontal normal would dominate every mean,
// and 8-bit normals cannot resolve steeper slopes anyway.
inline constexpr double max_slope = 20;

// Slope of a unit normal, limited to max_slope.
Vec2 slope_of(const Vec3& normal);

// Mip levels of a surface: mean depth, mean slope, and the slope variance lost by averaging.
//
// Level 0 is the surface's own texels. Level k + 1 has ceil(n / 2) texels a side and is the area-weighted
// mean of level k, so that means are preserved exactly at every size, powers of two or not, and the grid
// closes seamlessly under wrap. Slope is (dz/dx, dz/dy) of the height, -n_xy / n_z of the normal map.
// E[slope^2] is the same at every level: slope lost from the mean is carried by `variance` (Toksvig 2005;
// Olano and Baker, "LEAN mapping", 2010). Storage: 8 bytes a texel, for a third as many texels as level 0.
// Resolution: depth 1/65535; slope and standard deviation 1/32767 and 1/65535 of the map's steepest slope.
class Mips {
 public:
  struct Moments {
    double depth;      // fraction of max_depth
    Vec2 depth_slope;  // its derivative per texel of the level, of the bilinear patch; 0 from texel()
    Vec2 slope;        // mean
    double variance;   // E[|slope|^2] - |E[slope]|^2
  };

  // The levels that a footprint falls between: `level` with the remaining weight, and level + 1.
  struct LevelBlend {
    int level;
    double weight_of_next;
  };

  Mips() = default;
  // An empty `depth` is 0 everywhere; `normal` has grid.size() elements.
  Mips(const Grid& grid, std::span<const float> depth, std::span<const PackedNormal> normal);

  // The level of 1 x 1 texel; 0 when level 0 is that already. Levels 1..coarsest() are stored here.
  int coarsest() const { return int(levels_.size()); }
  const Grid& grid(int level) const { return levels_[std::size_t(level - 1)].grid; }
  Moments texel(int level, int i, int j) const;
  // Bilinear at uv.
  Moments bilinear(int level, const Vec2& uv) const;
  // Mean depth fraction of stored texel k of a level, for callers that interpolate themselves.
  double depth(int level, std::size_t k) const {
    return texels_[levels_[std::size_t(level - 1)].start + k].depth / 65535.0;
  }
  // For a footprint in texels of level 0: 1 or less is level 0, 2^k is level k, linear in between.
  LevelBlend levels_for(double footprint) const;
  std::size_t memory_bytes() const {
    return texels_.capacity() * sizeof(Texel) + levels_.capacity() * sizeof(Level);
  }

 private:
  struct Texel {
    std::uint16_t depth;
    std::int16_t slope_x, slope_y;
    std::uint16_t roughness;  // standard deviation
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
