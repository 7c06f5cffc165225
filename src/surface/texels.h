// The grid of texels of one mip level: how an index goes on beyond the border, and where a coordinate falls.
//
// Pure functions of integers and fractions; any thread; a few nanoseconds.
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

struct Grid {
  int width = 0;
  int height = 0;
  Edge edge = Edge::wrap;

  std::size_t size() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
  // Where texel (i, j) is stored; i, j any integer.
  std::size_t index(int i, int j) const { return row(j) + column(i); }
  std::size_t column(int i) const { return static_cast<std::size_t>(within(i, width)); }
  std::size_t row(int j) const {
    return static_cast<std::size_t>(within(j, height)) * static_cast<std::size_t>(width);
  }
  int within(int i, int n) const {
    if (static_cast<unsigned>(i) < static_cast<unsigned>(n)) return i;
    if (edge == Edge::clamp) return i < 0 ? 0 : n - 1;
    const int m = i % n;
    return m < 0 ? m + n : m;
  }
};

// Splits a texel coordinate into the cell's index and the place in it. Something that is not a number counts
// as far away.
struct Split {
  int index;
  double fraction;

  explicit Split(double coordinate) {
    // Far outside (a body a million metres away) the texture is periodic anyway: stay within int.
    const double bounded = coordinate > -1e9 ? std::min(coordinate, 1e9) : -1e9;
    const double floor = std::floor(bounded);
    index = static_cast<int>(floor);
    fraction = bounded - floor;
  }
};

// A unit normal in four bytes.

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

// Interpolation on a grid of texels: bilinear (what the relief is) and Catmull-Rom bicubic (C1, for forces).
//
// A layout (Grid, TexelTiles) says with row(j) + column(i) where texel (i, j) is stored, and `fetch(k)` gives
// the value stored at k. Derivatives are per texel. No allocation; any thread. Source: Catmull and Rom, "A
// class of local interpolating splines", 1974.

struct Interpolated {
  double value, d_x, d_y;
};

// The 2 x 2 texels around a coordinate (in texels, texel centres at integers), rows one after the other.
struct BilinearTaps {
  std::array<std::size_t, 4> index;
  double x, y;  // place between them, 0..1

  template <class Layout>
  BilinearTaps(const Layout& layout, double coordinate_x, double coordinate_y) {
    const Split sx(coordinate_x), sy(coordinate_y);
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

// Weights of four neighbours for the place f in 0..1 between the middle two, and their derivatives.
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
  const Split sx(coordinate_x), sy(coordinate_y);
  const CatmullRom cx(sx.fraction), cy(sy.fraction);
  std::array<std::size_t, 4> column;
  for (int k = 0; k < 4; ++k) column[static_cast<std::size_t>(k)] = layout.column(sx.index - 1 + k);
  Interpolated sum{0, 0, 0};
  for (std::size_t r = 0; r < 4; ++r) {
    const std::size_t row = layout.row(sy.index - 1 + static_cast<int>(r));
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

// The texels of a surface as queries want them: four by four, so that neighbours share cache lines.
//
// A line holds a tile of 16 depths, or of 16 normals. A cell's four corners are in 1.6 tiles on average where
// rows would cost 2.1 lines on 2 pages, a block of the pyramid (4 x 4 cells) in four tiles where rows would
// cost 6 lines on 5 pages. Immutable; any thread.

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

// Mip levels of a surface: mean depth, mean slope, and the roughness that averaging hid.
//
// Level 0 is the surface's own texels; level k + 1 has ceil(n / 2) texels a side and is the area-weighted
// mean of level k, so that means are kept exactly at every size, powers of two or not, and the grid closes
// seamlessly under wrap. Slope is (dz/dx, dz/dy) of the height as the normal tells it, -n_xy / n_z.
// E[slope^2] over a level is the same at every level: what leaves the mean slope goes to `variance` (Toksvig
// 2005; Olano and Baker, "LEAN mapping", 2010). Storage: 8 bytes a texel, a third as many texels as level 0.
// Steps: depth 1/65535; slope and root of variance 1/32767 and 1/65535 of the steepest slope of the map.
// Immutable; any thread.

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
