// A convex piece of a triangle, in weights (a, b) of its second and third corner; the first has 1 - a - b.
//
// On the stack; counter-clockwise. A triangle cut by the lines of a grid has at most seven corners.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "intaglio/vec.h"
#include "mesh/triangle_mesh.h"
#include "surface/surface.h"

namespace intaglio::surface {

class WeightPolygon {
 public:
  static constexpr std::size_t most_corners = 16;

  static WeightPolygon triangle() {
    WeightPolygon out;
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
  void add(const Vec2& corner) {
    if (count_ < most_corners) corners_[count_++] = corner;
  }
  Vec2 middle() const {
    Vec2 sum = Vec2::Zero();
    for (const Vec2& corner : *this) sum += corner;
    return sum / static_cast<double>(count_);
  }

  // The parts with slope . (a, b) + offset at most 0, and at least 0.
  void split(const Vec2& slope, double offset, WeightPolygon& below, WeightPolygon& above) const {
    double value = slope.dot(corners_[0]) + offset;
    for (std::size_t k = 0; k < count_; ++k) {
      const Vec2 &here = corners_[k], &there = corners_[k + 1 < count_ ? k + 1 : 0];
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
  std::array<Vec2, most_corners> corners_;
  std::size_t count_ = 0;
};

// The relief over one triangle of a curved base, and over one cell of it.
//
// The field: at weights (a, b) of a triangle's corners the base point p and the interpolated normal N are
// linear, n = N / |N|, the texture coordinate is linear and the height z = -depth bilinear in it; the relief
// is at X = p + z n. So it is what MeshPlacement::to_world says. Within a cell everything is smooth, and its
// derivatives are exact here. Metres; pure; no allocation.

struct ReliefTriangle {
  int index;
  Vec3 p, p_a, p_b;       // p + a p_a + b p_b
  Vec3 n, n_a, n_b;       // N likewise
  double least_normal;    // |N| is never less
  double bend_a, bend_b;  // n changes by no more for a unit of a, of b
  Vec2 x, x_a, x_b;       // in cells: texel (i, j) is at (i, j)

  // `texels`: how many the texture has along u and v.
  ReliefTriangle(const TriangleMesh& mesh, const Vec2& texels, int triangle);
  Vec2 cells(const Vec2& at) const { return x + at[0] * x_a + at[1] * x_b; }
};

// z near a place, in cells from there: within `play` of z + slope . (dx, dy).
struct Heights {
  double z;
  Vec2 slope;
  double play;
};

// A piece of the relief, nearly a flat polygon: within `play` of middle + da along_a + db along_b, at the
// corners of `outline` less `at`.
struct FlatPiece {
  Vec3 middle, along_a, along_b;
  double play;
  Vec2 at;
  const WeightPolygon& outline;

  FlatPiece(const ReliefTriangle& triangle, const WeightPolygon& polygon, const Heights& heights,
            const Vec2& middle_of_polygon);
  // The least of g . X, less what it is in the middle, without play.
  double least_along(const Vec3& g) const {
    const double g_a = g.dot(along_a), g_b = g.dot(along_b);
    double least = 0;
    for (const Vec2& corner : outline)
      least = std::min(least, g_a * (corner[0] - at[0]) + g_b * (corner[1] - at[1]));
    return least;
  }
  // No point of it is farther from the middle.
  double radius() const;
  // The weight, as a unit vector, across which to cut it in two.
  Vec2 longer_way() const;
};

// The relief over the part of a triangle that lies in one cell.
struct ReliefPiece {
  const ReliefTriangle& triangle;
  std::int64_t i, j;  // the cell, before wrapping
  double z, z_s, z_t, twist;
  WeightPolygon outline;

  // Place and derivatives at (a, b).
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
  Vec3 base_normal(const Vec2& weights) const {
    return (triangle.n + weights[0] * triangle.n_a + weights[1] * triangle.n_b).normalized();
  }
  Heights heights(const Vec2& middle) const;
};

// How high the relief is over a range of cells, and where to cut the range in two: the pyramid as a walk over
// a triangle sees it. The texture goes on beyond 0..1 as the edge mode says. No allocation; any thread.

// Cells from (i0, j0) to (i1, j1), both included, before wrapping.
struct CellRange {
  std::int64_t i0, i1, j0, j1;

  bool is_one() const { return i0 == i1 && j0 == j1; }
};

class ReliefCells {
 public:
  explicit ReliefCells(const Surface& surface);

  // The cells that a part of a triangle lies over; one for all where the relief is flat.
  CellRange range(const ReliefTriangle& triangle, const WeightPolygon& outline) const;
  // Bounds over a range, about a place in it (in cells).
  Heights heights(const CellRange& range, const Vec2& about) const;
  // Where to cut: axis 0 or 1, and the first cell of the second part. Blocks of the pyramid are cut at their
  // middle.
  struct Cut {
    int axis;
    std::int64_t cell;
  };
  Cut cut(const CellRange& range) const;
  // Sets heights and place of a piece that lies in a range of one cell.
  void load(const CellRange& one, ReliefPiece& piece) const;

  const Surface& surface() const { return surface_; }
  Vec2 texels() const { return {surface_.width(), surface_.height()}; }

 private:
  std::int64_t cut_between(std::int64_t first, std::int64_t last, std::int64_t cells) const;

  const Surface& surface_;
};

}  // namespace intaglio::surface
