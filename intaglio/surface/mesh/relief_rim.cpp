#include "intaglio/surface/mesh/relief_rim.h"

#include <cmath>

namespace intaglio::surface {

namespace {

constexpr double on_edge = 1e-9;     // in weights and cells
constexpr double downhill = 1e-6;    // sine of the angle under which a way is level
constexpr double same_place = 1e-6;  // of a texel: farther apart, the relief is torn

// The cells that hold a place, one to four: visit(range).
template <class Visit>
void for_each_cell(const ReliefCells& cells, const ReliefTriangle& triangle, const Vec2& weights,
                   const Visit& visit) {
  if (cells.surface().is_flat()) return visit(CellRange{0, 0, 0, 0});
  const Vec2 at = triangle.cells(weights);
  const auto first = [](double x) { return static_cast<std::int64_t>(std::floor(x - on_edge)); };
  const auto last = [](double x) { return static_cast<std::int64_t>(std::floor(x + on_edge)); };
  for (std::int64_t j = first(at[1]); j <= last(at[1]); ++j) {
    for (std::int64_t i = first(at[0]); i <= last(at[0]); ++i) visit(CellRange{i, i, j, j});
  }
}

// The part of a triangle that is in one cell.
WeightPolygon clipped(const ReliefTriangle& t, const CellRange& one, bool flat) {
  WeightPolygon out = WeightPolygon::triangle();
  if (flat) return out;
  const std::array<double, 2> low = {static_cast<double>(one.i0), static_cast<double>(one.j0)};
  for (int axis = 0; axis < 2; ++axis) {
    const Vec2 slope(t.x_a[axis], t.x_b[axis]);
    WeightPolygon below, above, left;
    out.split(slope, t.x[axis] - low[static_cast<std::size_t>(axis)], below, above);
    if (above.is_empty()) return above;
    above.split(slope, t.x[axis] - low[static_cast<std::size_t>(axis)] - 1, left, below);
    out = left;
    if (out.is_empty()) return out;
  }
  return out;
}

// Whether the distance to p falls from `weights` into some direction of the pieces of a triangle there.
bool falls(const ReliefMesh& relief, int index, const Vec2& weights, const Vec3& point, const Vec3& p) {
  const ReliefTriangle triangle = relief.triangle(index);
  const ReliefCells& cells = relief.cells();
  bool out = false;
  for_each_cell(cells, triangle, weights, [&](const CellRange& one) {
    if (out) return;
    ReliefPiece piece{triangle, 0, 0, 0, 0, 0, 0, clipped(triangle, one, cells.surface().is_flat())};
    if (piece.outline.is_empty()) return;
    cells.load(one, piece);
    const ReliefPiece::Jet jet = piece.at(weights);
    if ((jet.point - point).norm() > same_place * relief.texel()) return;
    const Vec3 away = jet.point - p;
    for (const Vec2& corner : piece.outline) {
      const Vec2 to = corner - weights;
      const Vec3 way = to[0] * jet.by_a + to[1] * jet.by_b;
      out = out || away.dot(way) < -downhill * away.norm() * way.norm();
    }
  });
  return out;
}

// Calls visit(triangle, weights) for the triangles that hold a place on the edge of one: itself included.
template <class Visit>
void for_each_around(const ReliefMesh& relief, int triangle, const Vec2& weights, const Visit& visit) {
  const std::array<double, 3> all = {1 - weights[0] - weights[1], weights[0], weights[1]};
  visit(triangle, weights);
  const TriangleFans& fans = relief.fans();
  std::size_t held = 3;  // a corner that the place is not opposite to
  bool is_inside = true;
  for (std::size_t k = 0; k < 3; ++k) {
    if (all[k] <= on_edge)
      is_inside = false;
    else
      held = k;
  }
  if (is_inside || held == 3) return;
  for (const int other : fans.around(fans.place(triangle, held))) {
    if (other == triangle) continue;
    std::array<double, 3> theirs{};
    bool holds = true;
    for (std::size_t k = 0; k < 3 && holds; ++k) {
      if (all[k] <= on_edge) continue;
      const int corner = fans.corner_at(other, fans.place(triangle, k));
      holds = corner >= 0;
      if (holds) theirs[static_cast<std::size_t>(corner)] = all[k];
    }
    if (holds) visit(other, Vec2(theirs[1], theirs[2]));
  }
}

}  // namespace

bool is_local_minimum(const ReliefMesh& relief, const MeshFeature& feature, const Vec3& p) {
  bool out = true;
  for_each_around(relief, feature.triangle, feature.weights, [&](int triangle, const Vec2& weights) {
    out = out && !falls(relief, triangle, weights, feature.point, p);
  });
  return out;
}

MeshPlace first_of(const ReliefMesh& relief, int triangle, const Vec2& weights) {
  MeshPlace out{triangle, weights};
  for_each_around(relief, triangle, weights, [&](int other, const Vec2& theirs) {
    if (other < out.triangle) out = {other, theirs};
  });
  return out;
}

bool is_beyond_border(const ReliefMesh& relief, int triangle, const Vec2& weights, const Vec3& away) {
  const std::array<double, 3> all = {1 - weights[0] - weights[1], weights[0], weights[1]};
  bool on_border = false;
  for (std::size_t k = 0; k < 3; ++k) {
    if (all[k] > on_edge) continue;
    for_each_around(relief, triangle, weights, [&](int other, const Vec2& theirs) {
      const std::array<double, 3> w = {1 - theirs[0] - theirs[1], theirs[0], theirs[1]};
      for (std::size_t corner = 0; corner < 3; ++corner)
        on_border = on_border || (w[corner] <= on_edge && relief.fans().is_border(other, corner));
    });
    break;
  }
  if (!on_border) return false;
  const ReliefTriangle t = relief.triangle(triangle);
  const Vec3 n = (t.n + weights[0] * t.n_a + weights[1] * t.n_b).normalized();
  // The relief may be as steep as it likes there; over its border it is left sideways.
  const Vec3 aside = away - away.dot(n) * n;
  return aside.norm() > 1e-6 * away.norm();
}

}  // namespace intaglio::surface
