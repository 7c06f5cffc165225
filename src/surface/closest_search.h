// The search that answers closest.h: a nearest-first descent of the pyramid, pruned by the best distance so
// far. What is pruned but within reach is kept for the features after the first, which go on from there
// instead of from the top. One object a question; on the stack, no allocation.
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

// How far 0 is from [low, high].
inline double away(double low, double high) {
  return std::max(std::max(low, -high), 0.0);
}

class ClosestSearch {
 public:
  // From p, on the side `sign` of the relief (1 above, -1 below); features nearer than `reach`, which may be
  // infinite. `goes_on`: whether next() will be called more than once.
  ClosestSearch(const Surface& surface, const Vec3& p, double sign, double reach, double min_angle,
                bool goes_on);

  // The nearest feature outside of the cones of those found so far, which are all that next() has given.
  std::optional<Feature> next(std::span<const Feature> found);

 private:
  // A quad of the pyramid whose blocks are to be looked at, in one of the copies of the texture.
  struct Entry {
    double bound2;
    int level, x, y;
    std::int8_t copy_x, copy_y;
    std::uint8_t blocks;  // bits: which of the four
  };
  struct Best {
    SeenPatch patch;
    NearestOnPatch at;
    int i, j;
  };
  // Of the three siblings left behind at each level of the deepest descent.
  static constexpr std::size_t deepest = 4 * 32;
  // Entries kept for later features. When there are more, the next feature starts from the top.
  static constexpr std::size_t most_later = 64;
  using Later = std::array<Entry, most_later>;

  struct Blocks {
    int level, x0, x1, y0, y1;
  };
  // Of a quad's blocks: bounds of the squared distance, and which are not ruled out.
  struct Seen {
    std::array<double, 4> bound2;
    unsigned open;
  };
  static constexpr int leaf = Pyramid::leaf;
  // A block of level 0.
  struct Leaf {
    int i, j;           // its first cell, in the copy at the origin
    int columns, rows;  // how many there are
    bool inner;         // whether they, and those around them, are where they are stored
    std::array<std::array<float, leaf + 1>, leaf + 1> depth;
    std::array<double, leaf> left, low;      // where the cells begin, as seen from p
    std::array<double, leaf * leaf> bound2;  // of the squared distance of each
  };

  void start();
  void search_copy(int copy_x, int copy_y);
  void enter_copy(int copy_x, int copy_y);
  Blocks blocks_within(double wide) const;
  double height_away(const Blocks& blocks) const;
  void descend(const Entry& top);
  void keep(Entry entry, unsigned blocks);
  Seen look_at(const Entry& entry) const { return is_far_ ? look_at<double>(entry) : look_at<float>(entry); }
  template <class T>
  Seen look_at(const Entry& entry) const;
  template <class T>
  void lay_out(const Entry& entry, Boxes<T>& boxes, bool& at_border) const;
  template <class T>
  TiltedPieces<T> planes_of(const Entry& entry, const Boxes<T>& boxes) const;
  template <class T>
  std::array<Four<T>, 2> spreads_of(const Entry& entry) const;
  unsigned existing(const Entry& entry) const;
  void prefetch(int x, int y) const;
  // What is farther is not wanted any more.
  double wanted() const { return goes_on_ ? reach_ : best_distance_; }
  // Of a height that is computed in T.
  template <class T>
  T height_loss() const {
    return loss<T> / 4 * static_cast<T>(surface_.max_depth() + std::abs(asking_.z()));
  }

  bool visit_leaf(int x, int y);
  void load(int x, int y, Leaf& out) const;
  template <class T>
  unsigned look_at(Leaf& block) const;
  SeenPatch patch_of(const Leaf& block, std::size_t k) const;
  bool has_no_minimum(const Leaf& block, std::size_t k) const;
  enum class Verdict { best, farther, useless };
  Verdict consider(const SeenPatch& patch, int i, int j);
  bool is_local_minimum(const Best& candidate) const;
  Vec3 normal_of(const Best& candidate) const;
  Vec3 direction_of(const Best& candidate) const;
  Feature feature() const;

  // Where a cell begins, as seen from p. Under clamp the outermost ones stand for all beyond: slide them
  // under p.
  double start_of(double first, double size, int i, int cells) const {
    if (surface_.edge() == Edge::wrap) return first;
    if (i < 0) return std::min(first, -0.5 * size);
    return i + 1 < cells ? first : std::max(first, -0.5 * size);
  }
  int index_of(int i, int cells, int under) const {
    if (surface_.edge() == Edge::wrap) return i;
    if (i < 0) return std::min(i, under);
    return i + 1 < cells ? i : std::max(i, under);
  }

  const Surface& surface_;
  const Pyramid& pyramid_;
  double w_, h_;
  Vec3 p_;                            // as asked
  Vec3 asking_;                       // the same, brought to the copy of the texture at the origin
  double sides_x_ = 0, sides_y_ = 0;  // by so many sides
  double sign_, min_angle_;
  double reach_;
  bool goes_on_, is_far_;
  Cones cones_;
  double best2_, best_distance_;
  std::optional<Best> best_;
  int under_i_ = 0, under_j_ = 0;
  int copy_x_ = 0, copy_y_ = 0;         // which is being searched, sides
  double origin_x_ = 0, origin_y_ = 0;  // its first cell's corner, as seen from p
  std::size_t later_count_ = 0;
  bool lost_ = true;  // whether what is within reach is not all in later_
  Later later_;
};

}  // namespace intaglio::surface
