// The relief over one triangle of a curved base, and over one cell of it.
//
// The field: at weights (a, b) of a triangle's corners the base point p and the interpolated normal N are
// linear, n = N / |N|, the texture coordinate is linear and the height z = -depth bilinear in it; the relief
// is at X = p + z n. So it is what MeshPlacement::to_world says. Within a cell everything is smooth, and its
// derivatives are exact here. Metres; pure; no allocation.
#pragma once

#include <array>
#include <cstdint>

#include "intaglio/surface/mesh/triangle_mesh.h"
#include "intaglio/surface/mesh/weight_polygon.h"

namespace intaglio::surface {

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

}  // namespace intaglio::surface
