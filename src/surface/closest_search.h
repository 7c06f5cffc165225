// The search behind closest.h: a nearest-first descent of the pyramid, pruned by the best distance so far.
// Blocks pruned but within reach are deferred, and later features resume from them. One object per query; on
// the stack, no allocation.
//
// closest_search.cpp has three parts: the descent over tiles and quads, the bounds of a quad's blocks, and
// the cells of a block of level 0 (a leaf).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include "surface/closest.h"
#include "surface/closest_bounds.h"
#include "surface/surface.h"

namespace intaglio::surface {

// Distance of 0 from [low, high].
inline double distance_to_interval(double low, double high) {
  return std::max(std::max(low, -high), 0.0);
}

class ClosestSearch {
 public:
  // From p, on the side `sign` of the relief (1 above, -1 below); features nearer than `reach`, which may be
  // infinite. `resumable`: next() will be called more than once.
  ClosestSearch(const Surface& surface, const Vec3& p, double sign, double reach, double min_angle,
                bool resumable);

  // The nearest feature outside the cones of `found`, which are all those that next() has returned.
  std::optional<Feature> next(std::span<const Feature> found);

 private:
  // A quad of the pyramid to be searched, in one of the tiles (copies of the texture).
  struct Entry {
    double bound2;
    int level, x, y;
    std::int8_t tile_x, tile_y;
    std::uint8_t blocks;  // mask
  };
  struct Best {
    LocalPatch patch;
    PatchPoint at;
    int i, j;
  };
  // Up to three siblings at each of 32 levels, and the current one.
  static constexpr std::size_t max_stack = 4 * 32;
  // When more entries are deferred, the next feature starts at the root.
  static constexpr std::size_t max_deferred = 64;
  using Deferred = std::array<Entry, max_deferred>;

  struct Blocks {
    int level, x0, x1, y0, y1;
  };
  // Lower bounds on the squared distance of a quad's blocks, and a mask of the blocks still possible.
  struct BlockBounds {
    std::array<double, 4> bound2;
    unsigned candidates;
  };
  static constexpr int leaf = Pyramid::leaf_cells;
  // A block of level 0.
  struct Leaf {
    int i, j;           // its first cell, in the base tile
    int columns, rows;  // of cells
    bool inner;         // no cell of it, or next to it, stands for others beyond the border
    std::array<std::array<float, leaf + 1>, leaf + 1> depth;
    std::array<double, leaf> left, low;      // where the cells begin, relative to the query point
    std::array<double, leaf * leaf> bound2;  // lower bound on each cell's squared distance
  };

  void start();
  void search_tile(int tile_x, int tile_y);
  void enter_tile(int tile_x, int tile_y);
  Blocks blocks_in_square(double half_side) const;
  double min_height_distance(const Blocks& blocks) const;
  void descend(const Entry& top);
  void defer(Entry entry, unsigned blocks);
  BlockBounds bound_blocks(const Entry& entry) const {
    return use_double_ ? bound_blocks<double>(entry) : bound_blocks<float>(entry);
  }
  template <class T>
  BlockBounds bound_blocks(const Entry& entry) const;
  template <class T>
  void block_rectangles(const Entry& entry, Boxes<T>& boxes, bool& at_border) const;
  template <class T>
  Slabs<T> slabs_of(const Entry& entry, const Boxes<T>& boxes) const;
  template <class T>
  std::array<Four<T>, 2> slope_spreads(const Entry& entry) const;
  unsigned existing_blocks(const Entry& entry) const;
  void prefetch(int x, int y) const;
  // Anything farther is ignored.
  double search_radius() const { return resumable_ ? reach_ : best_distance_; }
  // Bound on the rounding error of a height computed in T.
  template <class T>
  T height_slack() const {
    return rounding_slack<T> / 4 * T(surface_.max_depth() + std::abs(query_.z()));
  }

  bool visit_leaf(int x, int y);
  void load(int x, int y, Leaf& out) const;
  template <class T>
  unsigned bound_cells(Leaf& block) const;
  LocalPatch patch_of(const Leaf& block, std::size_t k) const;
  bool has_no_stationary_point(const Leaf& block, std::size_t k) const;
  enum class Verdict { best, farther, rejected };
  Verdict consider(const LocalPatch& patch, int i, int j);
  bool is_local_minimum(const Best& candidate) const;
  Vec3 normal_of(const Best& candidate) const;
  Vec3 direction_of(const Best& candidate) const;
  Feature feature() const;

  // Where a cell begins, relative to the query point. Under clamp the outermost cells extend to infinity:
  // move them below the query point.
  double cell_start(double first, double size, int i, int cells) const {
    if (surface_.edge() == Edge::wrap) return first;
    if (i < 0) return std::min(first, -0.5 * size);
    return i + 1 < cells ? first : std::max(first, -0.5 * size);
  }
  int cell_index(int i, int cells, int under) const {
    if (surface_.edge() == Edge::wrap) return i;
    if (i < 0) return std::min(i, under);
    return i + 1 < cells ? i : std::max(i, under);
  }

  const Surface& surface_;
  const Pyramid& pyramid_;
  double w_, h_;  // sides of a cell
  Vec3 query_as_given_;
  Vec3 query_;                        // moved into the base tile
  double tiles_x_ = 0, tiles_y_ = 0;  // number of tiles it was moved by
  double sign_, min_angle_;
  double reach_;
  bool resumable_, use_double_;
  Cones cones_;
  double best2_, best_distance_;
  std::optional<Best> best_;
  int cell_i_ = 0, cell_j_ = 0;         // the cell below (or above) the query point
  int tile_x_ = 0, tile_y_ = 0;         // the tile being searched
  double origin_x_ = 0, origin_y_ = 0;  // corner of its first cell, relative to the query point
  std::size_t deferred_count_ = 0;
  bool must_restart_ = true;  // deferred_ overflowed or was never filled
  Deferred deferred_;
};

}  // namespace intaglio::surface
