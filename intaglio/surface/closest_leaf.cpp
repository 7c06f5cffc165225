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

// The same for one cell of the block that is loaded, and the cells around it: bounds of half the squared
// distance's slope.
bool ClosestSearch::has_no_minimum(int column, int row, double left, double low) const {
  double z_low = infinity, z_high = -infinity, x_low = infinity, x_high = -infinity, y_low = infinity,
         y_high = -infinity;
  for (int r = row; r < row + 4; ++r) {
    for (int c = column; c < column + 4; ++c) {
      const double z = z_[std::size_t(r)][std::size_t(c)];
      z_low = std::min(z_low, z);
      z_high = std::max(z_high, z);
      if (c > column) {
        const double rise = z - z_[std::size_t(r)][std::size_t(c - 1)];
        x_low = std::min(x_low, rise);
        x_high = std::max(x_high, rise);
      }
      if (r > row) {
        const double rise = z - z_[std::size_t(r - 1)][std::size_t(c)];
        y_low = std::min(y_low, rise);
        y_high = std::max(y_high, rise);
      }
    }
  }
  const auto falls = [&](double start, double size, double rise_low, double rise_high) {
    const double least = std::min(std::min(z_low * rise_low, z_low * rise_high),
                                  std::min(z_high * rise_low, z_high * rise_high));
    const double most = std::max(std::max(z_low * rise_low, z_low * rise_high),
                                 std::max(z_high * rise_low, z_high * rise_high));
    return (start - size) * size + least > 0 || (start + 2 * size) * size + most < 0;
  };
  return falls(left, w_, x_low, x_high) || falls(low, h_, y_low, y_high);
}

// Fills z_ with the texels of the block whose first cell is (i, j); with those around it where they are asked
// for.
void ClosestSearch::load(int i, int j) {
  const TexelTiles& tiles = surface_.tiles();
  const double scale = -surface_.max_depth();
  const int first = cones_.empty() ? 1 : 0, end = cones_.empty() ? leaf + 2 : leaf + 3;
  std::array<std::size_t, leaf + 3> column;
  for (int c = first; c < end; ++c) column[std::size_t(c)] = tiles.column(i + c - 1);
  for (int r = first; r < end; ++r) {
    const std::size_t row = tiles.row(j + r - 1);
    double* z = z_[std::size_t(r)].data();
    for (int c = first; c < end; ++c) z[c] = scale * tiles.depth(row + column[std::size_t(c)]) - asking_.z();
  }
}

void ClosestSearch::visit_leaf(int x, int y) {
  const int i = pyramid_.first() + x * leaf, j = pyramid_.first() + y * leaf;
  const int columns = std::min(leaf, pyramid_.columns() - x * leaf),
            rows = std::min(leaf, pyramid_.rows() - y * leaf);
  load(i, j);
  // Under clamp the outermost cells are not where they are stored.
  const bool inner = surface_.edge() == Edge::wrap || (i >= 1 && j >= 1 && i + leaf + 1 < surface_.width() &&
                                                       j + leaf + 1 < surface_.height());
  std::array<double, leaf> left, low, dx2;
  for (int c = 0; c < leaf; ++c) {
    left[std::size_t(c)] = start((shift_i_ + i + c + 0.5) * w_ - asking_.x(), w_, i + c, surface_.width());
    const double dx = away(left[std::size_t(c)], left[std::size_t(c)] + w_);
    dx2[std::size_t(c)] = c < columns ? dx * dx : infinity;
  }
  using Row = Eigen::Array<double, leaf, 1>;
  std::array<double, leaf * leaf> bound2;
  const Eigen::Map<const Row> across2(dx2.data());
  for (int r = 0; r < rows; ++r) {
    low[std::size_t(r)] = start((shift_j_ + j + r + 0.5) * h_ - asking_.y(), h_, j + r, surface_.height());
    const double dy = away(low[std::size_t(r)], low[std::size_t(r)] + h_);
    const double* z0 = z_[std::size_t(r + 1)].data() + 1;
    const double* z1 = z_[std::size_t(r + 2)].data() + 1;
    const Eigen::Map<const Row> a(z0), b(z0 + 1), c(z1), d(z1 + 1);
    const Row dz = a.min(b).min(c.min(d)).max(-a.max(b).max(c.max(d))).max(0.0);
    Eigen::Map<Row> sum(&bound2[std::size_t(r) * leaf]);
    sum = across2 + dy * dy + dz * dz;
  }
  // The cell nearest to p in plan first: it often rules out the others.
  const auto under = [](double from, double size, int cells) {
    return std::size_t(std::clamp(-from / size, 0.0, cells - 1.0));
  };
  unsigned wanted = 0;
  for (std::size_t k = 0; k < std::size_t(rows) * leaf; ++k) wanted |= unsigned(bound2[k] < best2_) << k;
  for (std::size_t k = under(low[0], h_, rows) * leaf + under(left[0], w_, columns); wanted != 0;
       k = std::size_t(std::countr_zero(wanted))) {
    const bool near = (wanted >> k & 1u) != 0 && bound2[k] < best2_;
    wanted &= ~(1u << k);
    if (!near) continue;
    const std::size_t c = k % leaf, r = k / leaf;
    const SeenPatch patch(left[c], low[r], w_, h_, z_[r + 1][c + 1], z_[r + 1][c + 2], z_[r + 2][c + 1],
                          z_[r + 2][c + 2]);
    const int cell_i = shift_i_ + index_of(i + int(c), surface_.width(), under_i_);
    const int cell_j = shift_j_ + index_of(j + int(r), surface_.height(), under_j_);
    if ((best_ && best_->i == cell_i && best_->j == cell_j) || patch.beyond(best_distance_)) continue;
    if (!cones_.empty() && (near_in_cone(patch.at(0.5, 0.5), w_, h_, patch.z_s(0.5), patch.z_t(0.5),
                                         0.25 * std::abs(patch.twist)) ||
                            (inner && has_no_minimum(int(c), int(r), left[c], low[r]))))
      continue;
    consider(patch, cell_i, cell_j);
  }
}

void ClosestSearch::consider(const SeenPatch& patch, int i, int j) {
  const NearestOnPatch at = nearest(patch);
  if (!(at.distance2 < best2_)) return;
  const Best candidate{patch, at, i, j};
  // The nearest of all is a minimum and turns its outer side; others must show it.
  if (!cones_.empty()) {
    const Vec3 direction = direction_of(candidate);
    if (cones_.hold(direction) || direction.dot(normal_of(candidate)) <= 0 || !is_local_minimum(candidate))
      return;
  }
  best2_ = at.distance2;
  best_distance_ = std::sqrt(best2_);
  best_ = candidate;
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
