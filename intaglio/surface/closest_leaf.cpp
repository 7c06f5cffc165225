// The part of ClosestSearch that looks at single cells.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "intaglio/surface/closest_search.h"

namespace intaglio::surface {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

// Where the cells of block (x, y) are, and their texels.
void ClosestSearch::load(int x, int y, Leaf& out) const {
  out.i = pyramid_.first() + x * leaf;
  out.j = pyramid_.first() + y * leaf;
  out.columns = std::min(leaf, pyramid_.columns() - x * leaf);
  out.rows = std::min(leaf, pyramid_.rows() - y * leaf);
  // Under clamp the outermost cells are not where they are stored.
  out.inner =
      surface_.edge() == Edge::wrap || (out.i >= 1 && out.j >= 1 && out.i + leaf + 1 < surface_.width() &&
                                        out.j + leaf + 1 < surface_.height());
  const TexelTiles& tiles = surface_.tiles();
  std::array<std::size_t, leaf + 1> column;
  for (int c = 0; c <= leaf; ++c) column[std::size_t(c)] = tiles.column(out.i + c);
  for (int r = 0; r <= leaf; ++r) {
    const std::size_t row = tiles.row(out.j + r);
    for (std::size_t c = 0; c <= leaf; ++c) out.depth[std::size_t(r)][c] = tiles.depth(row + column[c]);
  }
  // To the bit as in Surface::cell, so that the same cell is as far whoever asks.
  const int i = copy_x_ * surface_.width() + out.i, j = copy_y_ * surface_.height() + out.j;
  for (int c = 0; c < leaf; ++c) {
    out.left[std::size_t(c)] = start_of((i + c + 0.5) * w_ - asking_.x(), w_, out.i + c, surface_.width());
    out.low[std::size_t(c)] = start_of((j + c + 0.5) * h_ - asking_.y(), h_, out.j + c, surface_.height());
  }
}

// Bounds of the cells' distances; the answer has a bit for each that may hold something wanted.
template <class T>
unsigned ClosestSearch::look_at(Leaf& block) const {
  using Row = Eigen::Array<float, 4, 1>;
  const T depth = static_cast<T>(surface_.max_depth()), z = static_cast<T>(asking_.z()),
          w = static_cast<T>(w_), h = static_cast<T>(h_);
  const T limit = static_cast<T>(wanted()) * (1 + loss<T>);
  const Four<T> left = Eigen::Map<const Four<double>>(block.left.data()).template cast<T>();
  unsigned open = 0;
  for (int r = 0; r < block.rows; ++r) {
    const float *one = block.depth[std::size_t(r)].data(), *other = block.depth[std::size_t(r + 1)].data();
    const Four<T> z0 = -depth * Eigen::Map<const Row>(one).template cast<T>() - z,
                  z1 = -depth * Eigen::Map<const Row>(one + 1).template cast<T>() - z,
                  z2 = -depth * Eigen::Map<const Row>(other).template cast<T>() - z,
                  z3 = -depth * Eigen::Map<const Row>(other + 1).template cast<T>() - z;
    const T low = static_cast<T>(block.low[std::size_t(r)]);
    const Boxes<T> boxes{left,
                         left + w,
                         Four<T>::Constant(low),
                         Four<T>::Constant(low + h),
                         z0.min(z1).min(z2.min(z3)) - height_loss<T>(),
                         z0.max(z1).max(z2.max(z3)) + height_loss<T>()};
    const TiltedPieces<T> planes{left + T(0.5) * w,
                                 Four<T>::Constant(low + T(0.5) * h),
                                 T(0.25) * ((z0 + z1) + (z2 + z3)),
                                 (T(0.5) / w) * ((z1 - z0) + (z3 - z2)),
                                 (T(0.5) / h) * ((z2 - z0) + (z3 - z1)),
                                 T(0.25) * ((z3 - z2) - (z1 - z0)).abs() + height_loss<T>(),
                                 w,
                                 h};
    const Four<T> bound2 = boxes.least_distance2().max(planes.least_distance2());
    unsigned row = less<T>(bound2, Four<T>::Constant(limit * limit));
    if (!cones_.empty() && row != 0) {
      const Reached<T> reached(boxes, limit);
      for (std::size_t k = 0; k < cones_.size(); ++k)
        row &= ~reached.planes_in_cone(planes, cones_.axis(k), cones_.cosine());
    }
    for (std::size_t c = 0; c < leaf; ++c)
      block.bound2[std::size_t(r) * leaf + c] = double(bound2[Eigen::Index(c)]);
    open |= (row & ((1u << block.columns) - 1)) << (r * leaf);
  }
  return open;
}

SeenPatch ClosestSearch::patch_of(const Leaf& block, std::size_t k) const {
  const std::size_t c = k % leaf, r = k / leaf;
  const auto z = [&](std::size_t row, std::size_t column) {
    return -surface_.max_depth() * double(block.depth[row][column]) - asking_.z();
  };
  return {block.left[c], block.low[r], w_, h_, z(r, c), z(r, c + 1), z(r + 1, c), z(r + 1, c + 1)};
}

// Looks at the cells of a block, nearest first. Whether any may still hold a later feature.
bool ClosestSearch::visit_leaf(int x, int y) {
  Leaf block;
  load(x, y, block);
  unsigned open = is_far_ ? look_at<double>(block) : look_at<float>(block), later = open;
  while (open != 0) {
    unsigned k = unsigned(std::countr_zero(open));
    for (unsigned rest = open & (open - 1); rest != 0; rest &= rest - 1) {
      const unsigned other = unsigned(std::countr_zero(rest));
      if (block.bound2[other] < block.bound2[k]) k = other;
    }
    if (block.bound2[k] >= best2_) break;
    open &= ~(1u << k);
    const int i = index_of(block.i + int(k % leaf), surface_.width(), under_i_) + copy_x_ * surface_.width(),
              j = index_of(block.j + int(k / leaf), surface_.height(), under_j_) +
                  copy_y_ * surface_.height();
    const SeenPatch patch = patch_of(block, k);
    // Beyond a border one cell stands in several places.
    if (best_ && best_->i == i && best_->j == j && best_->patch.x == patch.x && best_->patch.y == patch.y)
      continue;
    if ((!cones_.empty() && block.inner && has_no_minimum(block, k)) ||
        consider(patch, i, j) == Verdict::useless)
      later &= ~(1u << k);
  }
  return later != 0;
}

// Whether the slope of half the squared distance cannot be zero in a cell, nor in the cells around it.
bool ClosestSearch::has_no_minimum(const Leaf& block, std::size_t k) const {
  const int column = int(k % leaf), row = int(k / leaf);
  const TexelTiles& tiles = surface_.tiles();
  std::array<std::size_t, 4> at;
  for (int c = 0; c < 4; ++c) at[std::size_t(c)] = tiles.column(block.i + column + c - 1);
  double z_low = infinity, z_high = -infinity, x_low = infinity, x_high = -infinity, y_low = infinity,
         y_high = -infinity;
  std::array<double, 4> below{};
  for (int r = 0; r < 4; ++r) {
    const std::size_t from = tiles.row(block.j + row + r - 1);
    double before = 0;
    for (std::size_t c = 0; c < 4; ++c) {
      const double z = -surface_.max_depth() * double(tiles.depth(from + at[c])) - asking_.z();
      z_low = std::min(z_low, z);
      z_high = std::max(z_high, z);
      if (c > 0) {
        x_low = std::min(x_low, z - before);
        x_high = std::max(x_high, z - before);
      }
      if (r > 0) {
        y_low = std::min(y_low, z - below[c]);
        y_high = std::max(y_high, z - below[c]);
      }
      before = below[c] = z;
    }
  }
  const auto falls = [&](double start, double size, double rise_low, double rise_high) {
    const double least = std::min(std::min(z_low * rise_low, z_low * rise_high),
                                  std::min(z_high * rise_low, z_high * rise_high));
    const double most = std::max(std::max(z_low * rise_low, z_low * rise_high),
                                 std::max(z_high * rise_low, z_high * rise_high));
    return (start - size) * size + least > 0 || (start + 2 * size) * size + most < 0;
  };
  return falls(block.left[std::size_t(column)], w_, x_low, x_high) ||
         falls(block.low[std::size_t(row)], h_, y_low, y_high);
}

ClosestSearch::Verdict ClosestSearch::consider(const SeenPatch& patch, int i, int j) {
  const NearestOnPatch at = nearest(patch);
  if (!(at.distance2 < best2_)) return Verdict::farther;
  const Best candidate{patch, at, i, j};
  // The nearest of all is a minimum and turns its outer side; others must show it.
  if (!cones_.empty()) {
    const Vec3 direction = direction_of(candidate);
    if (cones_.hold(direction) || direction.dot(normal_of(candidate)) <= 0 || !is_local_minimum(candidate))
      return Verdict::useless;
  }
  best2_ = at.distance2;
  best_distance_ = std::sqrt(best2_);
  best_ = candidate;
  return Verdict::best;
}

Vec3 ClosestSearch::normal_of(const Best& b) const {
  return Vec3(-b.patch.z_s(b.at.t) / w_, -b.patch.z_t(b.at.s) / h_, 1).normalized();
}

Vec3 ClosestSearch::direction_of(const Best& b) const {
  const double length = std::sqrt(b.at.distance2);
  return length > 1e-12 ? Vec3(-sign_ / length * b.patch.at(b.at.s, b.at.t)) : normal_of(b);
}

// Whether the distance also grows out of the cell, where its nearest point is on the border. Along the border
// and inwards it grows, or the point would not be the cell's nearest.
bool ClosestSearch::is_local_minimum(const Best& candidate) const {
  const auto& [patch, at, i, j] = candidate;
  const Vec3 there = patch.at(at.s, at.t);
  const auto falls = [&](double along, double step, double rise) {
    return along * step + there.z() * rise < -1e-9 * there.norm() * (std::abs(step) + std::abs(rise));
  };
  if (at.s <= 0 || at.s >= 1) {
    const int out = at.s <= 0 ? -1 : 1;
    const Cell beyond = surface_.cell(i + out, j);
    const double rise =
        beyond.z[1] - beyond.z[0] + at.t * (beyond.z[3] - beyond.z[2] - beyond.z[1] + beyond.z[0]);
    if (falls(there.x(), out * w_, out * rise)) return false;
  }
  if (at.t <= 0 || at.t >= 1) {
    const int out = at.t <= 0 ? -1 : 1;
    const Cell beyond = surface_.cell(i, j + out);
    const double rise =
        beyond.z[2] - beyond.z[0] + at.s * (beyond.z[3] - beyond.z[2] - beyond.z[1] + beyond.z[0]);
    if (falls(there.y(), out * h_, out * rise)) return false;
  }
  return true;
}

}  // namespace intaglio::surface
