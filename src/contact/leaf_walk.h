// Visits the blocks of a rectangle's relief that may be near a convex body. Local frame, metres; no
// allocation. Internal to contact/.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "intaglio/vec.h"
#include "surface/surface.h"

namespace intaglio::contact {

// A bend of the relief below this slope counts as flat: no corner, no crease.
inline constexpr double flat_bend = 1e-6;

// A normal that may lean by a small `angle` beyond slope x = tan f: tan(f + angle) - tan(f) is about
// angle / cos^2 f = angle (1 + x^2).
inline double slope_slack(double angle, double slope2) {
  return angle * (1 + slope2);
}

// Value and gradient of a convex function at a point. The tangent plane there is a lower bound everywhere.
struct LinearBound {
  double value;
  Vec3 gradient;
};

// Bounds of a block from the pyramid: within +-`half_thickness` (vertically) of a parallelogram.
struct SlabPiece {
  Vec3 middle, side_x, side_y;
  double half_thickness;

  // The least that a convex function, or the linear one, can be in it.
  double lower_bound(const LinearBound& f) const {
    return f.value - 0.5 * std::abs(f.gradient.dot(side_x)) - 0.5 * std::abs(f.gradient.dot(side_y)) -
           half_thickness * std::abs(f.gradient.z());
  }
};

// Block (x, y) of a level of the pyramid.
inline SlabPiece slab_of(const surface::Surface& surface, int level, int x, int y) {
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

// Four by four cells, and the texels at their corners and next to them. Texel (i + c, j + r) is
// z[r + 1][c + 1]; cell (c, r), c and r from 0 to 3, is between texels (c, r) and (c + 1, r + 1):
//
//    r
//    4   .   o---o---o---o---o      o  corners of the cells
//    3   .   o---o---o---o---o      .  neighbours, which tell whether a texel or crease of the leaf
//    2   .   o---o---o---o---o         sticks out
//    1   .   o---o---o---o---o
//    0   .   o---o---o---o---o
//   -1   .   .   .   .   .   .
//       -1   0   1   2   3   4   c
//
// Texels outside the rectangle count as infinitely low: -1e6 m, safe in arithmetic.
struct Leaf {
  static constexpr int side = surface::Pyramid::leaf_cells;
  static constexpr double outside_z = -1e6;

  int i, j;
  // Clipped to the rectangle: texels in [begin, end), cells in [begin, last).
  int begin_c, end_c, last_c, begin_r, end_r, last_r;
  double w, h;
  std::array<std::array<double, side + 2>, side + 2> z;

  Leaf(const surface::Surface& surface, int first_i, int first_j);

  double at(int c, int r) const { return z[std::size_t(r + 1)][std::size_t(c + 1)]; }
  Vec3 texel(int c, int r) const { return {(i + c + 0.5) * w, (j + r + 0.5) * h, at(c, r)}; }

  // Whether the plane with these slopes through texel (c, r) is above the texels next to it, with a tolerance
  // given as slopes.
  bool is_summit(int c, int r, double slope_x, double slope_y, double slack_x, double slack_y) const {
    const double middle = at(c, r);
    return at(c + 1, r) - middle <= (slack_x + slope_x) * w &&
           at(c - 1, r) - middle <= (slack_x - slope_x) * w &&
           at(c, r + 1) - middle <= (slack_y + slope_y) * h &&
           at(c, r - 1) - middle <= (slack_y - slope_y) * h;
  }
  // Whether `up` lies in the cone of normals of texel (c, r), within `angle`.
  bool is_summit_along(int c, int r, const Vec3& up, double angle) const {
    const double x = -up.x() / up.z(), y = -up.y() / up.z();
    return is_summit(c, r, x, y, slope_slack(angle, x * x), slope_slack(angle, y * y));
  }
  // Whether the relief bends down at texel (c, r) along x and along y.
  bool is_convex(int c, int r) const {
    const double middle = 2 * at(c, r);
    return at(c - 1, r) + at(c + 1, r) - middle <= -flat_bend * w &&
           at(c, r - 1) + at(c, r + 1) - middle <= -flat_bend * h;
  }
};

// The block of four by four cells whose first is (i, j).
inline SlabPiece slab_of_leaf(const surface::Surface& surface, int i, int j) {
  const int first = surface.pyramid().first_cell();
  return slab_of(surface, 0, (i - first) / Leaf::side, (j - first) / Leaf::side);
}

// Calls visit(i, j) with the first cell of every block of four by four cells over the rectangle that overlaps
// low..high in plan and for which should_descend(slab) holds, for it and all blocks that contain it.
template <class ShouldDescend, class Visit>
void for_each_leaf(const surface::Surface& surface, const Vec2& low, const Vec2& high,
                   const ShouldDescend& should_descend, const Visit& visit) {
  using surface::Pyramid;
  const Pyramid& pyramid = surface.pyramid();
  const double w = surface.texel_u(), h = surface.texel_v();
  const int first = pyramid.first_cell();
  // Cells, counted from the first; -1 before it.
  const auto cell = [first](double at, double size, int cells) {
    return int(std::clamp(std::floor(at / size - 0.5) - first, -1.0, double(cells)));
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
    return should_descend(slab_of(surface, b.level, b.x, b.y));
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

// Fast conservative bounds of the relief's height over a rectangle low..high in plan, from at most nine
// blocks of the pyramid. Loose: includes whole blocks. With wrap, only one period is considered.
struct HeightRange {
  double low, high;  // z
};
HeightRange range_over(const surface::Surface& surface, const Vec2& low, const Vec2& high);
// The same over a square: `reach` metres to every side of a point.
inline HeightRange range_around(const surface::Surface& surface, const Vec2& at, double reach) {
  return range_over(surface, at - Vec2::Constant(reach), at + Vec2::Constant(reach));
}

// Bounds of where contacts of an edge, an arc's chord or an axis can lie in the relief.
//
// A point p of the edge and a point q of the relief are a candidate pair if they are at most `above` apart
// with the relief below the edge, or at most `below` apart with the relief above it. Consider the plane that
// contains the edge and is level across it; q cannot lie far below that plane, because q.z >= p.z - above,
// and because q is at most reach = max(above, below) away from p, so that the plane is at most slope * reach
// higher over q than at p. So
//   plane over q - q.z <= above + slope * reach,
// and anything lower is culled. An upright edge has no such plane.
class EdgeBounds {
 public:
  EdgeBounds(const Vec3& a, const Vec3& b, double above, double below)
      : a_(a), along_(b - a), length2_(along_.squaredNorm()), reach_(std::max(above, below)) {
    const double across2 = along_.head<2>().squaredNorm();
    if (across2 * 100 < length2_) return;
    const Vec2 slope = along_.z() / across2 * along_.head<2>();
    floor_ = {above + slope.norm() * reach_, Vec3(slope.x(), slope.y(), -1)};
    has_floor_ = true;
  }

  double reach() const { return reach_; }
  Vec2 low() const { return a_.head<2>().cwiseMin((a_ + along_).head<2>()) - Vec2::Constant(reach_); }
  Vec2 high() const { return a_.head<2>().cwiseMax((a_ + along_).head<2>()) + Vec2::Constant(reach_); }

  bool may_contain_contact(const SlabPiece& piece) const {
    if (has_floor_ && piece.lower_bound({depth_below_floor(piece.middle), floor_.gradient}) > 0) return false;
    const Vec3 offset = piece.middle - a_;
    const double u = std::min(std::max(along_.dot(offset) / length2_, 0.0), 1.0);
    const Vec3 difference = offset - u * along_;
    const double d = difference.norm();
    return d == 0 || piece.lower_bound({d, difference / d}) <= reach_;
  }
  // Whether a point of the relief is too low. A crease or a patch is too low if all its corners are.
  bool is_too_low(const Vec3& q) const { return has_floor_ && depth_below_floor(q) > 0; }

 private:
  double depth_below_floor(const Vec3& q) const { return floor_.gradient.dot(q - a_) - floor_.value; }

  Vec3 a_, along_;
  double length2_, reach_;
  bool has_floor_ = false;
  LinearBound floor_{0, Vec3::Zero()};
};

// Mask of a leaf's 5 x 5 texels, those beyond its cells included, that are not too low: bit 5 r + c.
inline unsigned mask_near(const Leaf& leaf, const EdgeBounds& bounds) {
  unsigned mask = 0;
  for (int r = 0; r <= Leaf::side; ++r) {
    for (int c = 0; c <= Leaf::side; ++c)
      mask |= unsigned(!bounds.is_too_low(leaf.texel(c, r))) << (5 * r + c);
  }
  return mask;
}

// Calls search.corner(leaf, c, r), search.crease(leaf, c, r, x, y) for the crease from texel (c, r) to
// (c + x, r + y), and search.patch(leaf, c, r) for the features that have a corner in the mask.
template <class Search>
void visit_features(const Search& search, const Leaf& leaf, unsigned mask) {
  for (int r = leaf.begin_r; r < leaf.end_r; ++r) {
    for (int c = leaf.begin_c; c < leaf.end_c; ++c) {
      const unsigned here = mask >> (5 * r + c);
      if ((here & 1) != 0) search.corner(leaf, c, r);
      if (c < leaf.last_c && (here & 3) != 0) search.crease(leaf, c, r, 1, 0);
      if (r < leaf.last_r && (here & 0x21) != 0) search.crease(leaf, c, r, 0, 1);
      if (c < leaf.last_c && r < leaf.last_r && (here & 0x63) != 0) search.patch(leaf, c, r);
    }
  }
}

}  // namespace intaglio::contact
