#include "sound/triangle_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace intaglio::sound {

namespace {

constexpr int cells_along_longest_side = 16;

double distance_to(const Vec3& p, const Triangle& t, const std::vector<Vec3>& points) {
  const Vec3 &a = points[std::size_t(t[0])], &b = points[std::size_t(t[1])], &c = points[std::size_t(t[2])];
  const Vec3 w = nearest_barycentric(p, a, b, c);
  return (w[0] * a + w[1] * b + w[2] * c - p).norm();
}

}  // namespace

Vec3 nearest_barycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp),
               d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return Vec3::UnitX();
  if (d3 >= 0 && d4 <= d3) return Vec3::UnitY();
  if (d6 >= 0 && d5 <= d6) return Vec3::UnitZ();
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0 && (d4 - d3) + (d5 - d6) > 0) {
    const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - t, t};
  }
  const double sum = va + vb + vc;
  // Degenerate triangle: return any corner.
  return sum > 0 ? Vec3(Vec3(va, vb, vc) / sum) : Vec3(Vec3::UnitX());
}

TriangleGrid::TriangleGrid(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
  if (triangles.empty()) return;
  Eigen::AlignedBox3d bounds;
  for (const Vec3& p : points) bounds.extend(p);
  low_ = bounds.min();
  cell_size_ = bounds.sizes().maxCoeff() / cells_along_longest_side;
  cells_ = (bounds.sizes() / cell_size_).array().ceil().cast<int>().max(1).min(cells_along_longest_side);

  const double half_diagonal = 0.5 * std::sqrt(3.0) * cell_size_;
  const double near = half_diagonal + cell_size_;  // cells farther from the surface keep one candidate
  const auto middle = [&](int cell) {
    const Vec3 index(cell % cells_[0], cell / cells_[0] % cells_[1], cell / (cells_[0] * cells_[1]));
    return Vec3(low_ + cell_size_ * (index + Vec3::Constant(0.5)));
  };
  // A point x of the cell is within half a diagonal h of its middle m, so |d(x, t) - d(m, t)| <= h for every
  // triangle t: t can be nearest to x only if d(m, t) <= d(m, nearest to m) + 2 h.
  std::vector<std::vector<std::pair<double, int>>> found(std::size_t(cells_.prod()));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    Eigen::AlignedBox3d box;
    for (const int p : triangles[t]) box.extend(points[std::size_t(p)]);
    const double reach = near + 2 * half_diagonal;
    const Eigen::Vector3i from = index_of(box.min() - Vec3::Constant(reach)),
                          to = index_of(box.max() + Vec3::Constant(reach));
    for (int z = from[2]; z <= to[2]; ++z) {
      for (int y = from[1]; y <= to[1]; ++y) {
        for (int x = from[0]; x <= to[0]; ++x) {
          const int cell = (z * cells_[1] + y) * cells_[0] + x;
          if (box.exteriorDistance(middle(cell)) > reach) continue;
          const double distance = distance_to(middle(cell), triangles[t], points);
          if (distance <= reach) found[std::size_t(cell)].emplace_back(distance, int(t));
        }
      }
    }
  }
  std::vector<int> nearest(found.size(), -1);
  for (std::size_t cell = 0; cell < found.size(); ++cell) {
    if (!found[cell].empty())
      nearest[cell] = std::min_element(found[cell].begin(), found[cell].end())->second;
  }
  flood_nearest(
      nearest, [&](int cell, int t) { return distance_to(middle(cell), triangles[std::size_t(t)], points); });
  for (std::size_t cell = 0; cell < found.size(); ++cell) {
    start_.push_back(int(candidates_.size()));
    candidates_.push_back(nearest[cell]);
    const double least = distance_to(middle(int(cell)), triangles[std::size_t(nearest[cell])], points);
    if (least > near) continue;
    for (const auto& [distance, t] : found[cell]) {
      if (distance <= least + 2 * half_diagonal && t != nearest[cell]) candidates_.push_back(t);
    }
  }
  start_.push_back(int(candidates_.size()));
}

// Gives every cell without a nearest triangle the best one of its neighbours', breadth-first.
template <class Distance>
void TriangleGrid::flood_nearest(std::vector<int>& nearest, Distance distance) const {
  std::vector<int> front;
  for (std::size_t cell = 0; cell < nearest.size(); ++cell) {
    if (nearest[cell] < 0) front.push_back(int(cell));
  }
  while (!front.empty()) {
    std::vector<int> remaining;
    std::vector<std::pair<int, int>> found;
    for (const int cell : front) {
      const Eigen::Vector3i at(cell % cells_[0], cell / cells_[0] % cells_[1],
                               cell / (cells_[0] * cells_[1]));
      int best = -1;
      for (int k = 0; k < 27; ++k) {
        const Eigen::Vector3i by = at + Eigen::Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
        if ((by.array() < 0).any() || (by.array() >= cells_.array()).any()) continue;
        const int t = nearest[std::size_t((by[2] * cells_[1] + by[1]) * cells_[0] + by[0])];
        if (t >= 0 && (best < 0 || distance(cell, t) < distance(cell, best))) best = t;
      }
      if (best < 0) {
        remaining.push_back(cell);
      } else {
        found.emplace_back(cell, best);
      }
    }
    if (found.empty()) {  // no cell has a candidate (overflow in extreme coordinates)
      for (const int cell : remaining) nearest[std::size_t(cell)] = 0;
      return;
    }
    for (const auto& [cell, t] : found) nearest[std::size_t(cell)] = t;
    front = std::move(remaining);
  }
}

Eigen::Vector3i TriangleGrid::index_of(const Vec3& p) const {
  Eigen::Vector3i index;
  for (int axis = 0; axis < 3; ++axis) {
    const double place = std::floor((p[axis] - low_[axis]) / cell_size_);
    index[axis] = int(std::clamp(place, 0.0, cells_[axis] - 1.0));
  }
  return index;
}

int TriangleGrid::cell_of(const Vec3& p) const {
  const Eigen::Vector3i index = index_of(p);
  return (index[2] * cells_[1] + index[1]) * cells_[0] + index[0];
}

TrianglePoint TriangleGrid::nearest(const Vec3& p, const std::vector<Vec3>& points,
                                    const std::vector<Triangle>& triangles) const {
  const Vec3 high = low_ + cell_size_ * cells_.cast<double>();
  const Vec3 inside = p.cwiseMax(low_).cwiseMin(high);
  const auto cell = std::size_t(cell_of(inside));
  TrianglePoint best;
  double least = std::numeric_limits<double>::infinity();
  for (int i = start_[cell]; i < start_[cell + 1]; ++i) {
    const int t = candidates_[std::size_t(i)];
    const Triangle& corner = triangles[std::size_t(t)];
    const Vec3 &a = points[std::size_t(corner[0])], &b = points[std::size_t(corner[1])],
               &c = points[std::size_t(corner[2])];
    const Vec3 w = nearest_barycentric(inside, a, b, c);
    const double distance = (w[0] * a + w[1] * b + w[2] * c - inside).squaredNorm();
    if (distance < least) {
      least = distance;
      best = {t, w};
    }
  }
  return best;
}

}  // namespace intaglio::sound
