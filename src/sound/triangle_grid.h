// The nearest triangle of a small triangle mesh, at bounded cost.
//
// A uniform grid over the bounding box lists for each cell the triangles that can be nearest to a point of
// it; a query scans the list of one cell. Points outside the box are first moved to its nearest point. A cell
// farther from the surface than its own size keeps one triangle, about the nearest to its middle: contact
// points are on the surface, so nobody asks there. Immutable, safe from any thread, no allocation in a query;
// about 0.5 microseconds on a mesh of 4,000 triangles, which takes 50 ms to make ready.
#pragma once

#include <array>
#include <vector>

#include "intaglio/vec.h"

namespace intaglio::sound {

using Triangle = std::array<int, 3>;

struct TrianglePoint {
  int triangle = 0;
  Vec3 barycentric = Vec3::UnitX();  // weights of the three corners
};

// The point of triangle a b c that is nearest to p, as barycentric weights. Source: Ericson, "Real-Time
// Collision Detection", 2005, §5.1.5.
Vec3 nearest_barycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

class TriangleGrid {
 public:
  TriangleGrid() = default;
  TriangleGrid(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles);

  // `points` and `triangles` are those it was made of.
  TrianglePoint nearest(const Vec3& p, const std::vector<Vec3>& points,
                        const std::vector<Triangle>& triangles) const;

 private:
  template <class Distance>
  void spread(std::vector<int>& nearest, Distance distance) const;
  Eigen::Vector3i index_of(const Vec3& p) const;
  int cell_of(const Vec3& p) const;

  Vec3 low_ = Vec3::Zero();
  double cell_size_ = 1;
  Eigen::Vector3i cells_ = Eigen::Vector3i::Zero();
  std::vector<int> start_;  // of each cell's list in candidates_, and one past the end
  std::vector<int> candidates_;
};

}  // namespace intaglio::sound
