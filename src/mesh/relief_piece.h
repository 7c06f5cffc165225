// The relief over one triangle of a curved base, and over one cell of it.
//
// The field: at weights (a, b) of a triangle's second and third corner (the first has 1 - a - b) the base
// point p and the interpolated normal N are linear, n = N / |N|, the texture coordinate is linear and the
// height z = -depth bilinear in it; the relief is at X = p + z n, the same field as
// MeshPlacement::to_world. Within a cell everything is smooth, and its derivatives are exact here.
//
// Metres; pure; any thread; on the stack, no allocation.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>

#include "intaglio/vec.h"
#include "mesh/triangle_mesh.h"
#include "surface/surface.h"

namespace intaglio::surface {

// All three weights of the corners.
inline Vec3 barycentric(const Vec2& weights) {
  return {1 - weights[0] - weights[1], weights[0], weights[1]};
}

// A convex part of a triangle in weights (a, b), counter-clockwise. A triangle cut by the lines of a grid has
// at most seven corners.
class BarycentricPolygon {
 public:
  static constexpr std::size_t max_corners = 16;

  static BarycentricPolygon triangle() {
    BarycentricPolygon out;
    out.add({0, 0});
    out.add({1, 0});
    out.add({0, 1});
    return out;
  }

  std::size_t size() const { return count_; }
  bool is_empty() const { return count_ < 3; }
  const Vec2& operator[](std::size_t k) const { return corners_[k]; }
  const Vec2* begin() const { return corners_.data(); }
  const Vec2* end() const { return corners_.data() + count_; }
  std::size_t after(std::size_t k) const { return k + 1 < count_ ? k + 1 : 0; }
  void add(const Vec2& corner) {
    assert(count_ < max_corners);
    if (count_ < max_corners) corners_[count_++] = corner;
  }
  // The mean of the corners.
  Vec2 centroid() const {
    Vec2 sum = Vec2::Zero();
    for (const Vec2& corner : *this) sum += corner;
    return sum / double(count_);
  }

  // The parts with slope . (a, b) + offset at most 0, and at least 0.
  void split(const Vec2& slope, double offset, BarycentricPolygon& below, BarycentricPolygon& above) const {
    double value = slope.dot(corners_[0]) + offset;
    for (std::size_t k = 0; k < count_; ++k) {
      const Vec2 &here = corners_[k], &there = corners_[after(k)];
      const double next = slope.dot(there) + offset;
      if (value <= 0) below.add(here);
      if (value >= 0) above.add(here);
      if ((value < 0 && next > 0) || (value > 0 && next < 0)) {
        const Vec2 between = here + value / (value - next) * (there - here);
        below.add(between);
        above.add(between);
      }
      value = next;
    }
  }

 private:
  std::array<Vec2, max_corners> corners_;
  std::size_t count_ = 0;
};

struct ReliefTriangle {
  int index;
  Vec3 p, p_a, p_b;                     // p + a p_a + b p_b
  Vec3 n, n_a, n_b;                     // N likewise
  double min_length;                    // lower bound of |N|
  double normal_rate_a, normal_rate_b;  // bounds of |dn/da|, |dn/db|
  Vec2 cell, cell_a, cell_b;            // position in cells likewise: texel (i, j) is at (i, j)

  // `texels`: how many the texture has along u and v.
  ReliefTriangle(const TriangleMesh& mesh, const Vec2& texels, int triangle);
  Vec2 cells(const Vec2& at) const { return cell + at[0] * cell_a + at[1] * cell_b; }
  Vec3 normal(const Vec2& at) const { return (n + at[0] * n_a + at[1] * n_b).normalized(); }
};

// z near a place: within +-`error` of z + slope . (dx, dy), dx and dy in cells from there.
struct HeightBounds {
  double z;
  Vec2 slope;
  double error;
};

// Linear approximation of a piece: within `error` of middle + da along_a + db along_b, where (da, db) are
// weights in `outline` less `at`, its centroid.
struct LinearPiece {
  Vec3 middle, along_a, along_b;
  double error;
  Vec2 at;
  const BarycentricPolygon& outline;

  LinearPiece(const ReliefTriangle& triangle, const BarycentricPolygon& polygon, const HeightBounds& heights,
              const Vec2& centroid);
  // The least of g . X, less its value in the middle, without `error`.
  double min_along(const Vec3& g) const {
    const double g_a = g.dot(along_a), g_b = g.dot(along_b);
    double least = 0;
    for (const Vec2& corner : outline)
      least = std::min(least, g_a * (corner[0] - at[0]) + g_b * (corner[1] - at[1]));
    return least;
  }
  // No point of the piece is farther from the middle.
  double radius() const;
  // The barycentric axis along which the piece is longer in metres, a unit vector: to split it across.
  Vec2 longer_axis() const;
};

// The relief over the part of a triangle that lies in one cell.
struct ReliefPiece {
  const ReliefTriangle& triangle;
  std::int64_t i, j;  // the cell, before wrapping
  double z, z_s, z_t, twist;
  BarycentricPolygon outline;

  // Position and derivatives at (a, b).
  struct Jet {
    Vec3 point, by_a, by_b;
    Vec3 n, n_a, n_b;
    double length, length_a, length_b;  // of N
    double h, h_a, h_b, h_aa, h_ab, h_bb;

    // g . X_aa, g . X_ab, g . X_bb.
    Vec3 second_along(const Vec3& g) const;
  };
  Jet at(const Vec2& weights) const;
  Vec3 point(const Vec2& weights) const;
  Vec3 base_normal(const Vec2& weights) const { return triangle.normal(weights); }
  HeightBounds heights(const Vec2& about) const;
  // Refers to this piece's outline.
  LinearPiece linear() const {
    const Vec2 centroid = outline.centroid();
    return {triangle, outline, heights(centroid), centroid};
  }

  // Calls visit(half) for the parts on both sides of the centroid along a barycentric axis.
  template <class Visit>
  void for_each_half(const Vec2& axis, const Visit& visit) const {
    BarycentricPolygon below, above;
    outline.split(axis, -axis.dot(outline.centroid()), below, above);
    for (const BarycentricPolygon* half : {&below, &above}) {
      if (half->is_empty()) continue;
      ReliefPiece part = *this;
      part.outline = *half;
      visit(part);
    }
  }
};

// Cells from (i0, j0) to (i1, j1), both included, before wrapping.
struct CellRange {
  std::int64_t i0, i1, j0, j1;

  bool is_one() const { return i0 == i1 && j0 == j1; }
};

// How high the relief is over a range of cells, and where to split it: the pyramid seen from a triangle.
// Beyond 0..1 the edge mode applies. No allocation; any thread.
class CellGrid {
 public:
  explicit CellGrid(const Surface& surface);

  // The cells that a part of a triangle lies over; one for all where the relief is flat.
  CellRange range(const ReliefTriangle& triangle, const BarycentricPolygon& outline) const;
  // Bounds over a range, relative to a point in it (in cells).
  HeightBounds heights(const CellRange& range, const Vec2& about) const;
  // Where to split: axis 0 or 1, and the first cell of the second part. Blocks of the pyramid are split at
  // their middle.
  struct Split {
    int axis;
    std::int64_t cell;
  };
  Split split(const CellRange& range) const;
  // The piece over a part of a triangle that lies in a range of one cell.
  ReliefPiece piece(const ReliefTriangle& triangle, const BarycentricPolygon& outline,
                    const CellRange& one) const;

  const Surface& surface() const { return surface_; }
  Vec2 texels() const { return {surface_.width(), surface_.height()}; }

 private:
  std::int64_t split_between(std::int64_t first, std::int64_t last, std::int64_t cells) const;

  const Surface& surface_;
};

}  // namespace intaglio::surface
