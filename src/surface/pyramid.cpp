#include "surface/pyramid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "intaglio/vec.h"

namespace intaglio::surface {

namespace {

constexpr float infinite_depth = std::numeric_limits<float>::infinity();

struct DepthRange {
  float low, high;
};

int half(int n) {
  return (n + 1) / 2;
}

// The texels of a block of level 0 and of the cells around it: texel (i, j) of the block is at [j + 1][i +
// 1]. Where a block has fewer cells its last texels are repeated: depths stay exact, the other bounds get
// looser.
class Block {
 public:
  Block(std::span<const float> depth, const Grid& grid, int i, int j, int columns, int rows) {
    const bool inside = i >= 1 && i + leaf + 1 < grid.width && columns == leaf;
    for (int b = 0; b < size; ++b) {
      const float* row = depth.data() + grid.row(j + std::min(b - 1, rows + (rows == leaf ? 1 : 0)));
      for (int a = 0; a < size; ++a) {
        const int from = i + std::min(a - 1, columns + (columns == leaf ? 1 : 0));
        d_[b][a] = inside ? row[i + a - 1] : row[grid.wrap_or_clamp(from, grid.width)];
      }
    }
  }
  DepthRange depths() const {
    Four low = Four::Constant(infinite_depth), high = -low;
    for (int b = 1; b < end; ++b) {
      low = low.min(load4(b, 1)).min(load4(b, 2));
      high = high.max(load4(b, 1)).max(load4(b, 2));
    }
    return {low.minCoeff(), high.maxCoeff()};
  }
  // Mean slope per cell, from one border to the other.
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
  // Bounds of the depth minus the plane with these slopes that is 0 at the middle.
  DepthRange residual(float slope_x, float slope_y) const {
    const Four left = slope_x * Four(-2, -1, 0, 1), right = slope_x * Four(-1, 0, 1, 2);
    Four low = Four::Constant(infinite_depth), high = -low;
    for (int b = 1; b < end; ++b) {
      const float along = slope_y * float(b - 3);
      const Four left_part = load4(b, 1) - left - along, right_part = load4(b, 2) - right - along;
      low = low.min(left_part).min(right_part);
      high = high.max(left_part).max(right_part);
    }
    return {low.minCoeff(), high.maxCoeff()};
  }
  // The largest difference from `slope` among the edges between two texels along x, and along y.
  float spread_x(float slope) const {
    Four largest = Four::Zero();
    for (int b = 0; b < size; ++b) {
      for (const int a : {0, 2}) largest = largest.max((load4(b, a + 1) - load4(b, a) - slope).abs());
    }
    return largest.maxCoeff();
  }
  float spread_y(float slope) const {
    Four largest = Four::Zero();
    for (int b = 1; b < size; ++b) {
      for (const int a : {0, 3}) largest = largest.max((load4(b, a) - load4(b - 1, a) - slope).abs());
    }
    return largest.maxCoeff();
  }

 private:
  static constexpr int leaf = Pyramid::leaf_cells;
  static constexpr int end = leaf + 2;
  static constexpr int size = leaf + 3;

  // Rows of 5, 6 or 7 values are read as two overlapping vectors of four.
  using Four = Eigen::Array4f;
  Eigen::Map<const Four> load4(int b, int a) const { return Eigen::Map<const Four>(&d_[b][a]); }

  float d_[size][size];
};

// Largest difference between neighbours along a row or a column, including across the seam.
double steepest_step(std::span<const float> depth, const Grid& grid) {
  float largest = 0;
  for (int j = 0; j < grid.height; ++j) {
    const float* row = depth.data() + grid.row(j);
    const float* above = depth.data() + grid.row(j + 1);
    largest =
        std::max(largest, std::abs(row[grid.wrap_or_clamp(grid.width, grid.width)] - row[grid.width - 1]));
    for (int i = 0; i < grid.width; ++i) largest = std::max(largest, std::abs(above[i] - row[i]));
    for (int i = 0; i + 1 < grid.width; ++i) largest = std::max(largest, std::abs(row[i + 1] - row[i]));
  }
  return largest;
}

}  // namespace

Pyramid::Pyramid(std::span<const float> depth, const Grid& grid) {
  if (depth.empty()) return;
  const int beyond = grid.edge == Edge::clamp ? 1 : 0;
  first_ = -beyond;
  columns_ = grid.width + beyond;
  rows_ = grid.height + beyond;
  std::size_t quads = 0;
  int width = (columns_ + leaf_cells - 1) / leaf_cells;
  int height = (rows_ + leaf_cells - 1) / leaf_cells;
  do {
    width = half(width);
    height = half(height);
    levels_.push_back({quads, width});
    quads += std::size_t(width) * std::size_t(height);
    if (level_1_ == 0) level_1_ = quads;
  } while (width > 1 || height > 1);
  slabs_.resize(quads);
  Bounds4 empty;
  empty.shallow.fill(infinite_depth);
  empty.deep.fill(-infinite_depth);
  quads_.assign(quads - level_1_, empty);
  const auto [least, greatest] = std::minmax_element(depth.begin(), depth.end());
  total_range_ = {*least, *greatest};
  build_leaves(depth, grid);
  for (int level = 1; level < levels(); ++level) build_level(level);
}

void Pyramid::build_leaves(std::span<const float> depth, const Grid& grid) {
  // Two slopes differ by at most twice the steepest one, plus the rounding of the stored slope.
  const double steepest = steepest_step(depth, grid);
  spread_unit_ = steepest > 0 ? (2 * steepest + slope_unit) / 255 : 0;
  for (int y = 0; exists(0, 0, y); ++y) {
    for (int x = 0; exists(0, x, y); ++x) {
      const Block texels(depth, grid, first_ + x * leaf_cells, first_ + y * leaf_cells,
                         std::min(leaf_cells, columns_ - x * leaf_cells),
                         std::min(leaf_cells, rows_ - y * leaf_cells));
      // Rounded as stored.
      const auto sx = float(quantise_slope(texels.slope_x())), sy = float(quantise_slope(texels.slope_y()));
      const DepthRange rest = texels.residual(sx, sy);
      store({sx, sy, texels.spread_x(sx), texels.spread_y(sy), rest.low, rest.high}, block(0, x, y));
      if (levels() == 1) continue;
      const DepthRange depths = texels.depths();
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
      store(merge_children(level, x, y), block(level, x, y));
      if (level + 1 == levels()) continue;
      const Range range = this->range(level, x, y);
      const std::size_t up = block(level + 1, x / 2, y / 2);
      Bounds4& quad = quads_[up / 4 - level_1_];
      quad.shallow[up % 4] = std::min(quad.shallow[up % 4], float(range.shallow));
      quad.deep[up % 4] = std::max(quad.deep[up % 4], float(range.deep));
    }
  }
}

// The slab of a block from those of its children, with the mean of their slopes.
//
// Let the parent's plane be p(x, y) = slope . (x, y) about the middle of the parent. The middle of a child is
// a quarter side off, at (+-quarter, +-quarter), where the parent's plane is -`middle`. Relative to that
// plane, the child's slab at a distance (dx, dy) from the child's middle is
//   [low, high] + middle + difference_x dx + difference_y dy,   |dx|, |dy| <= quarter,
// and the last two terms are within +-`tilt`.
Pyramid::Slab Pyramid::merge_children(int level, int x, int y) const {
  std::array<Slab, 4> child;
  std::array<bool, 4> there;
  Slab out{0, 0, 0, 0, infinite_depth, -infinite_depth};
  double count = 0;
  for (int k = 0; k < 4; ++k) {
    const auto n = std::size_t(k);
    const int cx = 2 * x + (k & 1), cy = 2 * y + (k >> 1);
    there[n] = exists(level - 1, cx, cy);
    if (!there[n]) continue;
    child[n] = slab(level - 1, cx, cy);
    out.slope_x += child[n].slope_x;
    out.slope_y += child[n].slope_y;
    ++count;
  }
  out.slope_x = quantise_slope(out.slope_x / count);
  out.slope_y = quantise_slope(out.slope_y / count);
  const double quarter = 0.25 * block_cells(level);
  for (std::size_t n = 0; n < 4; ++n) {
    if (!there[n]) continue;
    const double slope_difference_x = child[n].slope_x - out.slope_x,
                 slope_difference_y = child[n].slope_y - out.slope_y;
    const double middle = -out.slope_x * ((n & 1) != 0 ? quarter : -quarter) -
                          out.slope_y * ((n >> 1) != 0 ? quarter : -quarter);
    const double tilt = quarter * (std::abs(slope_difference_x) + std::abs(slope_difference_y));
    out.low = std::min(out.low, child[n].low + middle - tilt);
    out.high = std::max(out.high, child[n].high + middle + tilt);
    out.spread_x = std::max(out.spread_x, child[n].spread_x + std::abs(slope_difference_x));
    out.spread_y = std::max(out.spread_y, child[n].spread_y + std::abs(slope_difference_y));
  }
  return out;
}

// A slope as stored.
double Pyramid::quantise_slope(double slope) {
  return std::clamp(std::nearbyint(slope / slope_unit), -32767.0, 32767.0) * slope_unit;
}

// Rounds outwards, plus one step to cover float arithmetic. The 16-bit steps cover +-2. Depths are in 0..1,
// but the plane of a block that is mostly beyond the last cell may have any height in its middle: then a
// horizontal slab over 0..1 is stored.
void Pyramid::store(const Slab& slab, std::size_t block) {
  if (slab.low < -1.99 || slab.high > 1.99) {
    const double spread_x = slab.spread_x + std::abs(slab.slope_x),
                 spread_y = slab.spread_y + std::abs(slab.slope_y);
    return store({0, 0, spread_x, spread_y, 0, 1}, block);
  }
  const auto step = [](double value) { return std::int16_t(std::clamp(value, -32767.0, 32767.0)); };
  const auto spread = [&](double value) {
    return std::uint8_t(spread_unit_ > 0 ? std::min(255.0, std::ceil(value / spread_unit_ + 1e-3)) : 0.0);
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
