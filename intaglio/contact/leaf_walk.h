// The relief near a convex thing, block by block. Local frame, metres; no allocation. Internal to contact/.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "intaglio/surface/surface.h"

namespace intaglio::contact {

// Value and gradient of a convex function at a point: what bounds it from below everywhere.
struct Tangent {
  double value;
  Vec3 gradient;
};

// A piece of the relief as the pyramid knows it: within `play` above and below a parallelogram with these
// sides.
struct Piece {
  Vec3 middle, side_x, side_y;
  double play;

  // The least that a convex function, or the linear one, can be in it.
  double least(const Tangent& t) const {
    return t.value - 0.5 * std::abs(t.gradient.dot(side_x)) - 0.5 * std::abs(t.gradient.dot(side_y)) -
           play * std::abs(t.gradient.z());
  }
};

// Four by four cells, and the texels around them: texel (i + c, j + r) is z[r + 1][c + 1], c and r from -1 to
// 4. Texels outside of the rectangle count as infinitely low (by a number that is still good to reckon with).
struct Leaf {
  static constexpr int side = surface::Pyramid::leaf;
  static constexpr double nowhere = -1e6;

  int i, j;
  // On the rectangle: texels from begin to end, of those that are a cell's first; cells from begin to last.
  int begin_c, end_c, last_c, begin_r, end_r, last_r;
  double w, h;
  std::array<std::array<double, side + 2>, side + 2> z;

  Leaf(const surface::Surface& surface, int first_i, int first_j);

  double at(int c, int r) const { return z[std::size_t(r + 1)][std::size_t(c + 1)]; }
  Vec3 texel(int c, int r) const { return {(i + c + 0.5) * w, (j + r + 0.5) * h, at(c, r)}; }
  // Whether the plane of these slopes through texel (c, r) is above the texels next to it; they may rise over
  // it by the slack, a slope too.
  bool is_summit(int c, int r, double slope_x, double slope_y, double slack_x, double slack_y) const {
    const double middle = at(c, r);
    return at(c + 1, r) - middle <= (slack_x + slope_x) * w &&
           at(c - 1, r) - middle <= (slack_x - slope_x) * w &&
           at(c, r + 1) - middle <= (slack_y + slope_y) * h &&
           at(c, r - 1) - middle <= (slack_y - slope_y) * h;
  }
};

// Block (x, y) of a level of the pyramid.
inline Piece piece_of(const surface::Surface& surface, int level, int x, int y) {
  const surface::Pyramid& pyramid = surface.pyramid();
  const int side = surface::Pyramid::side(level);
  const double w = surface.texel_u(), h = surface.texel_v(), scale = -surface.max_depth();
  const surface::Pyramid::Slab slab = pyramid.slab(level, x, y);
  const double a = scale * side * slab.slope_x, c = scale * side * slab.slope_y;
  const Vec3 middle((pyramid.first() + 0.5 + (x + 0.5) * side) * w,
                    (pyramid.first() + 0.5 + (y + 0.5) * side) * h, scale * 0.5 * (slab.low + slab.high));
  return {middle, Vec3(side * w, 0, a), Vec3(0, side * h, c), -0.5 * scale * (slab.high - slab.low)};
}
// The block of four by four cells whose first is (i, j).
inline Piece piece_of_leaf(const surface::Surface& surface, int i, int j) {
  const int first = surface.pyramid().first();
  return piece_of(surface, 0, (i - first) / Leaf::side, (j - first) / Leaf::side);
}

// Calls visit(i, j) with the first cell of every block of four by four cells over the rectangle that overlaps
// low..high in plan and that is wanted: wanted(piece) of the block, and of those that hold it.
template <class Wanted, class Visit>
void for_each_leaf(const surface::Surface& surface, const Vec2& low, const Vec2& high, const Wanted& wanted,
                   const Visit& visit) {
  using surface::Pyramid;
  const Pyramid& pyramid = surface.pyramid();
  const double w = surface.texel_u(), h = surface.texel_v();
  const int first = pyramid.first();
  // Cells, counted from the first.
  const auto cell = [first](double at, double size, int cells) {
    return static_cast<int>(std::clamp(std::floor(at / size - 0.5) - first, -1.0, double(cells)));
  };
  const int i0 = std::max(cell(low.x(), w, pyramid.columns()), 0),
            i1 = std::min(cell(high.x(), w, pyramid.columns()), pyramid.columns() - 1),
            j0 = std::max(cell(low.y(), h, pyramid.rows()), 0),
            j1 = std::min(cell(high.y(), h, pyramid.rows()), pyramid.rows() - 1);
  if (i0 > i1 || j0 > j1) return;
  struct Block {
    int level, x, y;
  };
  int level = 0;
  while (level + 1 < pyramid.levels() && Pyramid::side(level) < std::max(i1 - i0, j1 - j0)) ++level;
  std::array<Block, 4 * 32> stack;
  const auto try_block = [&](const Block& b) {
    const int side = Pyramid::side(b.level);
    if (b.x * side > i1 || (b.x + 1) * side <= i0 || b.y * side > j1 || (b.y + 1) * side <= j0) return false;
    return wanted(piece_of(surface, b.level, b.x, b.y));
  };
  const int side = Pyramid::side(level);
  for (int y = j0 / side; y <= j1 / side; ++y) {
    for (int x = i0 / side; x <= i1 / side; ++x) {
      if (!try_block({level, x, y})) continue;
      std::size_t count = 0;
      stack[count++] = {level, x, y};
      while (count > 0) {
        const Block b = stack[--count];
        if (b.level == 0) {
          visit(first + b.x * Leaf::side, first + b.y * Leaf::side);
          continue;
        }
        for (int k = 3; k >= 0; --k) {
          const Block child{b.level - 1, 2 * b.x + (k & 1), 2 * b.y + (k >> 1)};
          if (try_block(child)) stack[count++] = child;
        }
      }
    }
  }
}

}  // namespace intaglio::contact
