#include "surface/pyramid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "intaglio/vec.h"

namespace intaglio::surface {

namespace {

constexpr float nothing = std::numeric_limits<float>::infinity();

struct Bounds {
  float low, high;
};

int half(int n) {
  return (n + 1) / 2;
}

// The texels of a block of level 0 and of the cells around it: texel (i, j) of the block is at [j + 1][i +
// 1]. Where a block has fewer cells its last texels are repeated: that leaves depths exact and makes the rest
// looser.
class Block {
 public:
  Block(std::span<const float> depth, const Grid& grid, int i, int j, int columns, int rows) {
    const bool inside = i >= 1 && i + leaf + 1 < grid.width && columns == leaf;
    for (int b = 0; b < size; ++b) {
      const float* row = depth.data() + grid.row(j + std::min(b - 1, rows + (rows == leaf ? 1 : 0)));
      for (int a = 0; a < size; ++a) {
        const int from = i + std::min(a - 1, columns + (columns == leaf ? 1 : 0));
        d_[b][a] = inside ? row[i + a - 1] : row[grid.within(from, grid.width)];
      }
    }
  }
  Bounds depths() const {
    Four low = Four::Constant(nothing), high = -low;
    for (int b = 1; b < end; ++b) {
      low = low.min(four(b, 1)).min(four(b, 2));
      high = high.max(four(b, 1)).max(four(b, 2));
    }
    return {low.minCoeff(), high.maxCoeff()};
  }
  // Mean slope per cell, from border to border.
  float slope_x() const {
    float sum = 0;
    for (int b = 1; b < end; ++b) sum += d_[b][end - 1] - d_[b][1];
    return sum / ((leaf + 1) * leaf);
  }
  float slope_y() const {
    float sum = 0;
    for (int a = 1; a < end; ++a) sum += d_[end - 1][a] - d_[1][a];
    return sum / ((leaf + 1) * leaf);
  }
  // Bounds of the depth over the plane of these slopes that is 0 at the middle.
  Bounds beside(float slope_x, float slope_y) const {
    const Four left = slope_x * Four(-2, -1, 0, 1), right = slope_x * Four(-1, 0, 1, 2);
    Four low = Four::Constant(nothing), high = -low;
    for (int b = 1; b < end; ++b) {
      const float along = slope_y * static_cast<float>(b - 3);
      const Four one = four(b, 1) - left - along, other = four(b, 2) - right - along;
      low = low.min(one).min(other);
      high = high.max(one).max(other);
    }
    return {low.minCoeff(), high.maxCoeff()};
  }
  // The most that the slope of an edge between two texels, along x or along y, differs from this.
  float spread_x(float slope) const {
    Four most = Four::Zero();
    for (int b = 0; b < size; ++b) {
      for (const int a : {0, 2}) most = most.max((four(b, a + 1) - four(b, a) - slope).abs());
    }
    return most.maxCoeff();
  }
  float spread_y(float slope) const {
    Four most = Four::Zero();
    for (int b = 1; b < size; ++b) {
      for (const int a : {0, 3}) most = most.max((four(b, a) - four(b - 1, a) - slope).abs());
    }
    return most.maxCoeff();
  }

 private:
  static constexpr int leaf = Pyramid::leaf;
  static constexpr int end = leaf + 2;
  static constexpr int size = leaf + 3;

  // Rows of 5, 6 and 7 are covered by two fours that overlap.
  using Four = Eigen::Array4f;
  Eigen::Map<const Four> four(int b, int a) const { return Eigen::Map<const Four>(&d_[b][a]); }

  float d_[size][size];
};

// Greatest difference between neighbours along a row or a column, across the seam too.
double steepest_step(std::span<const float> depth, const Grid& grid) {
  float most = 0;
  for (int j = 0; j < grid.height; ++j) {
    const float* row = depth.data() + grid.row(j);
    const float* above = depth.data() + grid.row(j + 1);
    most = std::max(most, std::abs(row[grid.within(grid.width, grid.width)] - row[grid.width - 1]));
    for (int i = 0; i < grid.width; ++i) most = std::max(most, std::abs(above[i] - row[i]));
    for (int i = 0; i + 1 < grid.width; ++i) most = std::max(most, std::abs(row[i + 1] - row[i]));
  }
  return most;
}

}  // namespace

Pyramid::Pyramid(std::span<const float> depth, const Grid& grid) {
  if (depth.empty()) return;
  const int beyond = grid.edge == Edge::clamp ? 1 : 0;
  first_ = -beyond;
  columns_ = grid.width + beyond;
  rows_ = grid.height + beyond;
  std::size_t quads = 0;
  int width = (columns_ + leaf - 1) / leaf;
  int height = (rows_ + leaf - 1) / leaf;
  do {
    width = half(width);
    height = half(height);
    levels_.push_back({quads, width});
    quads += static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    if (level_1_ == 0) level_1_ = quads;
  } while (width > 1 || height > 1);
  slabs_.resize(quads);
  Bounds4 empty;
  empty.shallow.fill(nothing);
  empty.deep.fill(-nothing);
  quads_.assign(quads - level_1_, empty);
  const auto [least, most] = std::minmax_element(depth.begin(), depth.end());
  whole_ = {*least, *most};
  build_leaves(depth, grid);
  for (int level = 1; level < levels(); ++level) build_level(level);
}

void Pyramid::build_leaves(std::span<const float> depth, const Grid& grid) {
  // No slope differs from another by more than twice the steepest; what is stored is rounded besides.
  const double steepest = steepest_step(depth, grid);
  spread_unit_ = steepest > 0 ? (2 * steepest + slope_unit) / 255 : 0;
  for (int y = 0; exists(0, 0, y); ++y) {
    for (int x = 0; exists(0, x, y); ++x) {
      const Block texels(depth, grid, first_ + x * leaf, first_ + y * leaf,
                         std::min(leaf, columns_ - x * leaf), std::min(leaf, rows_ - y * leaf));
      // As they will be stored.
      const auto sx = static_cast<float>(rounded(texels.slope_x())),
                 sy = static_cast<float>(rounded(texels.slope_y()));
      const Bounds rest = texels.beside(sx, sy);
      pack({sx, sy, texels.spread_x(sx), texels.spread_y(sy), rest.low, rest.high}, block(0, x, y));
      if (levels() == 1) continue;
      const Bounds depths = texels.depths();
      const std::size_t up = block(1, x / 2, y / 2);
      Bounds4& quad = quads_[up / 4 - level_1_];
      quad.shallow[up % 4] = std::min(quad.shallow[up % 4], depths.low);
      quad.deep[up % 4] = std::max(quad.deep[up % 4], depths.high);
    }
  }
}

void Pyramid::build_level(int level) {
  for (int y = 0; exists(level, 0, y); ++y) {
    for (int x = 0; exists(level, x, y); ++x) {
      pack(joined(level, x, y), block(level, x, y));
      if (level + 1 == levels()) continue;
      const Range range = this->range(level, x, y);
      const std::size_t up = block(level + 1, x / 2, y / 2);
      Bounds4& quad = quads_[up / 4 - level_1_];
      quad.shallow[up % 4] = std::min(quad.shallow[up % 4], static_cast<float>(range.shallow));
      quad.deep[up % 4] = std::max(quad.deep[up % 4], static_cast<float>(range.deep));
    }
  }
}

// The slab of a block from those of its children: the mean slopes, and the children's planes at their
// corners.
Pyramid::Slab Pyramid::joined(int level, int x, int y) const {
  std::array<Slab, 4> child;
  std::array<bool, 4> there;
  Slab out{0, 0, 0, 0, nothing, -nothing};
  double count = 0;
  for (int k = 0; k < 4; ++k) {
    const auto n = static_cast<std::size_t>(k);
    const int cx = 2 * x + (k & 1), cy = 2 * y + (k >> 1);
    there[n] = exists(level - 1, cx, cy);
    if (!there[n]) continue;
    child[n] = slab(level - 1, cx, cy);
    out.slope_x += child[n].slope_x;
    out.slope_y += child[n].slope_y;
    ++count;
  }
  out.slope_x = rounded(out.slope_x / count);
  out.slope_y = rounded(out.slope_y / count);
  const double quarter = 0.25 * side(level);
  for (std::size_t n = 0; n < 4; ++n) {
    if (!there[n]) continue;
    const double more_x = child[n].slope_x - out.slope_x, more_y = child[n].slope_y - out.slope_y;
    // At the middle of the child, and from there to its corners.
    const double middle = -out.slope_x * ((n & 1) != 0 ? quarter : -quarter) -
                          out.slope_y * ((n >> 1) != 0 ? quarter : -quarter);
    const double tilt = quarter * (std::abs(more_x) + std::abs(more_y));
    out.low = std::min(out.low, child[n].low + middle - tilt);
    out.high = std::max(out.high, child[n].high + middle + tilt);
    out.spread_x = std::max(out.spread_x, child[n].spread_x + std::abs(more_x));
    out.spread_y = std::max(out.spread_y, child[n].spread_y + std::abs(more_y));
  }
  return out;
}

// A slope as it will be stored.
double Pyramid::rounded(double slope) {
  return std::clamp(std::nearbyint(slope / slope_unit), -32767.0, 32767.0) * slope_unit;
}

// One step more than rounding outward asks for, which covers the arithmetic in float. Steps hold +-2. Depths
// are in 0..1, but the plane of a block that is mostly beyond the last cell may be anywhere in its middle: a
// level slab holds everything then.
void Pyramid::pack(const Slab& slab, std::size_t block) {
  if (slab.low < -1.99 || slab.high > 1.99) {
    const double spread_x = slab.spread_x + std::abs(slab.slope_x),
                 spread_y = slab.spread_y + std::abs(slab.slope_y);
    return pack({0, 0, spread_x, spread_y, 0, 1}, block);
  }
  const auto step = [](double value) {
    return static_cast<std::int16_t>(std::clamp(value, -32767.0, 32767.0));
  };
  const auto spread = [&](double value) {
    return static_cast<std::uint8_t>(
        spread_unit_ > 0 ? std::min(255.0, std::ceil(value / spread_unit_ + 1e-3)) : 0.0);
  };
  Slabs4& slabs = slabs_[block / 4];
  const std::size_t k = block % 4;
  slabs.slope_x[k] = step(slab.slope_x / slope_unit);
  slabs.slope_y[k] = step(slab.slope_y / slope_unit);
  slabs.low[k] = step(std::floor(slab.low / depth_unit) - 1);
  slabs.high[k] = step(std::ceil(slab.high / depth_unit) + 1);
  slabs.spread_x[k] = spread(slab.spread_x);
  slabs.spread_y[k] = spread(slab.spread_y);
}

}  // namespace intaglio::surface
