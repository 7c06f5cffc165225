// The search that answers closest.h: a nearest-first descent of the pyramid, pruned by the best distance so
// far. One object a descent; on the stack, no allocation.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "intaglio/surface/closest.h"

namespace intaglio::surface {

// How far 0 is from [low, high].
inline double away(double low, double high) {
  return std::max(std::max(low, -high), 0.0);
}

// The directions around a feature already found, as seen from the asking point.
class Cones {
 public:
  Cones(std::span<const Feature> found, double sign, double min_angle)
      : found_(found), sign_(sign), cos_(std::cos(min_angle)), sin_(std::sin(min_angle)) {}

  bool empty() const { return found_.empty(); }
  bool hold(const Vec3& direction) const;
  // Whether a ball, its centre as seen from the asking point, is wholly within one cone. False when that is
  // not certain.
  bool hold_ball(const Vec3& centre, double radius) const;
  // Whether all of a parallelogram (closest_cell.h), give or take `play` along z, that is nearer than `reach`
  // is within one cone: where it is far enough along the cone's axis, it can only be.
  bool hold_near(const Vec3& middle, double w, double h, double z_s, double z_t, double play,
                 double reach) const;

 private:
  std::span<const Feature> found_;
  double sign_, cos_, sin_;
};

// One descent: the nearest feature that is nearer than a limit and outside all cones.
class ClosestSearch {
 public:
  // From p, on the side `sign` of the relief (1 above, -1 below). `limit` may be infinite.
  ClosestSearch(const Surface& surface, const Vec3& p, double sign, double limit, const Cones& cones);

  std::optional<Feature> run();

 private:
  struct Entry {
    double bound2;
    int level, x, y;
  };
  struct Best {
    SeenPatch patch;
    NearestOnPatch at;
    int i, j;
  };
  // Of the three siblings left behind at each level of the deepest descent.
  static constexpr std::size_t deepest = 4 * 32;

  struct Blocks {
    int level, x0, x1, y0, y1;
  };

  void search_copy(int shift_i, int shift_j);
  Blocks blocks_within(double wide) const;
  double height_away(const Blocks& blocks) const;
  void descend(const Entry& top);
  std::size_t near_children(const Entry& entry, std::array<Entry, 4>& children) const;
  void prefetch(int x, int y) const;
  void visit_leaf(int x, int y);
  void load(int i, int j);
  bool is_useless(int level, int x, int y) const;
  // Whether a parallelogram (closest_cell.h), give or take `play`, is within a cone; or what of it is nearer
  // than the best so far.
  bool in_cone(const Vec3& middle, double w, double h, double z_s, double z_t, double play) const;
  bool near_in_cone(const Vec3& middle, double w, double h, double z_s, double z_t, double play) const;
  bool has_no_minimum(int column, int row, double left, double low) const;
  void consider(const SeenPatch& patch, int i, int j);
  bool is_local_minimum(const Best& candidate) const;
  Vec3 normal_of(const Best& candidate) const;
  Vec3 direction_of(const Best& candidate) const;
  Feature feature() const;
  // Where a cell begins, as seen from p. Under clamp the outermost ones stand for all beyond: slide them
  // under p.
  double start(double first, double size, int i, int cells) const {
    if (surface_.edge() == Edge::wrap) return first;
    if (i < 0) return std::min(first, -0.5 * size);
    return i + 1 < cells ? first : std::max(first, -0.5 * size);
  }
  int index_of(int i, int cells, int under) const {
    if (surface_.edge() == Edge::wrap) return i;
    if (i < 0) return std::min(i, under);
    return i + 1 < cells ? i : std::max(i, under);
  }

  static constexpr int leaf = Pyramid::leaf;

  const Surface& surface_;
  const Pyramid& pyramid_;
  double w_, h_;
  Vec3 p_;                            // as asked
  Vec3 asking_;                       // the same, brought to the copy of the texture at the origin
  double sides_x_ = 0, sides_y_ = 0;  // by so many sides
  double sign_;
  const Cones& cones_;
  double best2_, best_distance_;
  std::optional<Best> best_;
  int under_i_ = 0, under_j_ = 0;
  int shift_i_ = 0, shift_j_ = 0;                         // of the copy being searched, cells
  double origin_x_ = 0, origin_y_ = 0;                    // its first cell's corner, as seen from p
  std::array<std::array<double, leaf + 3>, leaf + 3> z_;  // texels of a block, as seen from p
};

}  // namespace intaglio::surface
