// The relief near a convex thing, block by block. Local frame, metres; no allocation. Internal to contact/.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "surface/surface.h"

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
  static constexpr int side = surface::Pyramid::leaf_cells;
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
  const int side = surface::Pyramid::block_cells(level);
  const double w = surface.texel_u(), h = surface.texel_v(), scale = -surface.max_depth();
  const surface::Pyramid::Slab slab = pyramid.slab(level, x, y);
  const double a = scale * side * slab.slope_x, c = scale * side * slab.slope_y;
  const Vec3 middle((pyramid.first_cell() + 0.5 + (x + 0.5) * side) * w,
                    (pyramid.first_cell() + 0.5 + (y + 0.5) * side) * h,
                    scale * 0.5 * (slab.low + slab.high));
  return {middle, Vec3(side * w, 0, a), Vec3(0, side * h, c), -0.5 * scale * (slab.high - slab.low)};
}
// The block of four by four cells whose first is (i, j).
inline Piece piece_of_leaf(const surface::Surface& surface, int i, int j) {
  const int first = surface.pyramid().first_cell();
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
  const int first = pyramid.first_cell();
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
  while (level + 1 < pyramid.levels() && Pyramid::block_cells(level) < std::max(i1 - i0, j1 - j0)) ++level;
  std::array<Block, 4 * 32> stack;
  const auto try_block = [&](const Block& b) {
    const int side = Pyramid::block_cells(b.level);
    if (b.x * side > i1 || (b.x + 1) * side <= i0 || b.y * side > j1 || (b.y + 1) * side <= j0) return false;
    return wanted(piece_of(surface, b.level, b.x, b.y));
  };
  const int side = Pyramid::block_cells(level);
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

// How high and how deep the relief is somewhere, roughly and at once. Internal to contact/.

struct HeightRange {
  double low, high;  // z, local frame, metres
};

// Bounds of the relief over low..high in plan, from at most nine blocks of the pyramid; loose by what lies
// beside the rectangle in them. Under wrap only one period is looked at.
HeightRange range_over(const surface::Surface& surface, const Vec2& low, const Vec2& high);

// A straight edge, an arc's chord or an axis with what may be a partner of it in the relief. Internal to
// contact/.

// A pair of points of rod and relief counts when they are `above` apart or nearer with the relief below, or
// `below` with the relief above. Elsewhere there is nothing to look for.
class Rod {
 public:
  Rod(const Vec3& a, const Vec3& b, double above, double below)
      : a_(a), along_(b - a), length2_(along_.squaredNorm()), reach_(std::max(above, below)) {
    const double across2 = along_.head<2>().squaredNorm();
    // The plane through the rod that is level across it; there is none for an upright one.
    if (across2 * 100 < length2_) return;
    const Vec2 slope = along_.z() / across2 * along_.head<2>();
    level_ = {0, Vec3(slope.x(), slope.y(), -1)};
    // The partner is this far aside at most.
    level_.value = above + slope.norm() * reach_;
    is_level_ = true;
  }

  double reach() const { return reach_; }
  Vec2 low() const { return a_.head<2>().cwiseMin((a_ + along_).head<2>()) - Vec2::Constant(reach_); }
  Vec2 high() const { return a_.head<2>().cwiseMax((a_ + along_).head<2>()) + Vec2::Constant(reach_); }

  bool may_meet(const Piece& piece) const {
    if (is_level_ && piece.least({drop(piece.middle), level_.gradient}) > 0) return false;
    const Vec3 away = piece.middle - a_;
    const double u = std::min(std::max(along_.dot(away) / length2_, 0.0), 1.0);
    const Vec3 apart = away - u * along_;
    const double d = apart.norm();
    return d == 0 || piece.least({d, apart / d}) <= reach_;
  }
  // Whether a point of the relief is too far below. Where all corners of a crease or a patch are, it is.
  bool is_below(const Vec3& q) const { return is_level_ && drop(q) > 0; }

 private:
  double drop(const Vec3& q) const { return level_.gradient.dot(q - a_) - level_.value; }

  Vec3 a_, along_;
  double length2_, reach_;
  bool is_level_ = false;
  Tangent level_{0, Vec3::Zero()};
};

// Which texels of a leaf, the ones beyond its cells too, are not too far below a rod: bit 5 r + c.
inline unsigned texels_up(const Leaf& leaf, const Rod& rod) {
  unsigned up = 0;
  for (int r = 0; r <= Leaf::side; ++r) {
    for (int c = 0; c <= Leaf::side; ++c) up |= unsigned(!rod.is_below(leaf.texel(c, r))) << (5 * r + c);
  }
  return up;
}

// Calls corner, crease_x, crease_y and patch for what of the leaf has a corner that is up.
template <class Search>
void search_leaf(const Search& search, const Leaf& leaf, unsigned up) {
  for (int r = leaf.begin_r; r < leaf.end_r; ++r) {
    for (int c = leaf.begin_c; c < leaf.end_c; ++c) {
      const unsigned here = up >> (5 * r + c);
      if ((here & 1) != 0) search.corner(leaf, c, r);
      if (c < leaf.last_c && (here & 3) != 0) search.crease_x(leaf, c, r);
      if (r < leaf.last_r && (here & 0x21) != 0) search.crease_y(leaf, c, r);
      if (c < leaf.last_c && r < leaf.last_r && (here & 0x63) != 0) search.patch(leaf, c, r);
    }
  }
}

}  // namespace intaglio::contact
