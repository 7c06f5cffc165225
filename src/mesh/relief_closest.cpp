#include "mesh/relief_closest.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh/relief_minimum.h"
#include "surface/closest.h"

namespace intaglio::surface {

namespace {

constexpr std::size_t max_features = 6;

MeshFeature feature_of(const ReliefPiece& piece, const Vec2& weights) {
  MeshFeature out;
  out.triangle = piece.triangle.index;
  out.weights = weights;
  out.cell_i = piece.i;
  out.cell_j = piece.j;
  out.point = piece.point(weights);
  return out;
}

// Outer normal of the relief.
Vec3 normal_of(const ReliefPiece& piece, const Vec2& weights) {
  const ReliefPiece::Jet jet = piece.at(weights);
  const Vec3 normal = jet.by_a.cross(jet.by_b);
  return normal.norm() > 0 ? Vec3(normal.normalized()) : jet.n;
}

// The nearest piece of the relief.
template <class DistanceFrom>
class Nearest {
 public:
  Nearest(const DistanceFrom& from, double limit) : from_(from), limit_(limit) {}

  double limit() const { return limit_; }
  double lower_bound(const Bounds& box) const { return from_.lower_bound(box); }
  double lower_bound(const LinearPiece& piece) const { return from_.lower_bound(piece); }
  void visit(const ReliefPiece& piece) {
    PieceMinimiser<DistanceFrom> minimiser(piece, from_, limit_value());
    if (!minimiser.run()) return;
    limit_ = DistanceFrom::distance(minimiser.best().value);
    value_ = minimiser.best().value;
    found_ = feature_of(piece, minimiser.best().weights);
    base_normal_ = piece.base_normal(minimiser.best().weights);
    normal_ = normal_of(piece, minimiser.best().weights);
  }
  const std::optional<MeshFeature>& found() const { return found_; }
  const Vec3& base_normal() const { return base_normal_; }
  const Vec3& normal() const { return normal_; }

 private:
  // Requires a real improvement, so that rounding does not report the same point again across an edge.
  double limit_value() const {
    return found_ ? value_ - 1e-14 * std::abs(value_) : DistanceFrom::value(limit_);
  }

  const DistanceFrom& from_;
  double limit_, value_ = 0;
  std::optional<MeshFeature> found_;
  Vec3 base_normal_ = Vec3::Zero(), normal_ = Vec3::Zero();
};

// Sets sign, distance and direction of a feature; `away` leads from it to the query point.
void set_sign(const ReliefMesh& relief, const Vec3& away, const Vec3& base_normal, const Vec3& normal,
              MeshFeature& feature) {
  const double distance = away.norm();
  if (distance <= 1e-12 * relief.texel_size()) {
    feature.distance = 0;
    feature.direction = normal;
    return;
  }
  double sign = away.dot(base_normal) < 0 ? -1 : 1;
  if (sign < 0 && is_beyond_border(relief, feature.triangle, feature.weights, away)) sign = 1;
  feature.distance = sign * distance;
  feature.direction = sign / distance * away;
}

// The nearest local minimum outside of the cones of those found before.
class NextNearest {
 public:
  NextNearest(const ReliefMesh& relief, const PointDistance& from, double limit, const Cones& cones)
      : relief_(relief), from_(from), limit_(limit), cones_(cones) {}

  double limit() const { return limit_; }
  double lower_bound(const Bounds& box) const { return from_.lower_bound(box); }
  double lower_bound(const LinearPiece& piece) const {
    const double bound = from_.lower_bound(piece);
    if (bound < limit_ && cones_.contains_ball(piece.middle - from_.centre, piece.radius()))
      return std::numeric_limits<double>::infinity();
    return bound;
  }
  void visit(const ReliefPiece& piece) {
    PieceMinimiser<PointDistance> minimiser(piece, from_, PointDistance::value(limit_));
    if (!minimiser.run()) return;
    const Vec2 weights = minimiser.best().weights;
    const double distance = PointDistance::distance(minimiser.best().value);
    const Vec3 away = from_.centre - piece.point(weights);
    if (distance == 0 || away.dot(piece.base_normal(weights)) <= 0 || cones_.contains(away / distance))
      return;
    MeshFeature next = feature_of(piece, weights);
    if (!is_local_minimum(relief_, next, from_.centre)) return;
    next.distance = distance;
    next.direction = away / distance;
    found_ = next;
    limit_ = distance;
  }
  const std::optional<MeshFeature>& found() const { return found_; }

 private:
  const ReliefMesh& relief_;
  const PointDistance& from_;
  double limit_;
  const Cones& cones_;
  std::optional<MeshFeature> found_;
};

// The lowest piece that is not near those found before.
class Lowest {
 public:
  Lowest(const PlaneDistance& from, double limit, std::span<const MeshFeature> others, double apart)
      : from_(from), limit_(limit), others_(others), apart_(apart) {}

  double limit() const { return limit_; }
  double lower_bound(const Bounds& box) const { return from_.lower_bound(box); }
  double lower_bound(const LinearPiece& piece) const {
    if (!others_.empty() && is_near(piece.middle, apart_ - piece.radius()))
      return std::numeric_limits<double>::infinity();
    return from_.lower_bound(piece);
  }
  void visit(const ReliefPiece& piece) {
    PieceMinimiser<PlaneDistance> minimiser(piece, from_, limit_);
    if (!minimiser.run()) return;
    const Vec2 weights = minimiser.best().weights;
    if (is_near(piece.point(weights), apart_)) return;
    limit_ = minimiser.best().value;
    found_ = feature_of(piece, weights);
    found_->distance = limit_;
    found_->direction = -from_.normal;
  }
  const std::optional<MeshFeature>& found() const { return found_; }

 private:
  bool is_near(const Vec3& point, double within) const {
    return std::any_of(others_.begin(), others_.end(),
                       [&](const MeshFeature& other) { return (other.point - point).norm() < within; });
  }

  const PlaneDistance& from_;
  double limit_;
  std::span<const MeshFeature> others_;
  double apart_;
  std::optional<MeshFeature> found_;
};

}  // namespace

std::optional<MeshFeature> closest_point(const ReliefMesh& relief, const Vec3& p, double reach) {
  if (!p.allFinite() || !(reach > 0)) return std::nullopt;
  const PointDistance point{p};
  Nearest<PointDistance> nearest(point, reach);
  relief.visit_pieces(nearest);
  std::optional<MeshFeature> out = nearest.found();
  if (out) set_sign(relief, p - out->point, nearest.base_normal(), nearest.normal(), *out);
  return out;
}

std::size_t closest_features(const ReliefMesh& relief, const Vec3& p, double reach, double min_angle,
                             std::span<MeshFeature> out) {
  if (out.empty()) return 0;
  const auto first = closest_point(relief, p, reach);
  if (!first) return 0;
  out[0] = *first;
  if (first->distance <= 0) return 1;
  const PointDistance point{p};
  std::array<Feature, max_features> found;
  std::size_t count = 0;
  const auto keep = [&](const MeshFeature& feature) {
    found[count].direction = feature.direction;
    out[count++] = feature;
  };
  keep(*first);
  const std::size_t most = std::min(out.size(), max_features);
  while (count < most) {
    const Cones cones(std::span<const Feature>(found).first(count), 1, min_angle);
    NextNearest next(relief, point, reach, cones);
    relief.visit_pieces(next);
    if (!next.found()) break;
    keep(*next.found());
  }
  return count;
}

std::optional<MeshFeature> closest_to_segment(const ReliefMesh& relief, const Vec3& from, const Vec3& to,
                                              double reach) {
  const Vec3 along = to - from;
  const double length = along.norm();
  if (!from.allFinite() || !to.allFinite() || !(reach > 0)) return std::nullopt;
  if (length == 0) return closest_point(relief, from, reach);
  const SegmentDistance segment{from, along / length, length};
  Nearest<SegmentDistance> nearest(segment, reach);
  relief.visit_pieces(nearest);
  std::optional<MeshFeature> out = nearest.found();
  if (out)
    set_sign(relief, segment.nearest(out->point) - out->point, nearest.base_normal(), nearest.normal(), *out);
  return out;
}

std::optional<MeshFeature> lowest_point(const ReliefMesh& relief, const Vec3& normal, double offset,
                                        double below, std::span<const MeshFeature> others, double apart) {
  if (!normal.allFinite() || !std::isfinite(offset)) return std::nullopt;
  const PlaneDistance plane{normal, offset};
  Lowest lowest(plane, below, others, apart);
  relief.visit_pieces(lowest);
  return lowest.found();
}

namespace {

constexpr double edge_tolerance = 1e-9;    // in weights and cells
constexpr double min_descent_sine = 1e-6;  // below it a direction counts as level
constexpr double tear_tolerance = 1e-6;    // of a texel: farther apart, the relief is torn

// Calls visit(range) for the cells that contain a place, one to four.
template <class Visit>
void for_each_cell(const CellGrid& cells, const ReliefTriangle& triangle, const Vec2& weights,
                   const Visit& visit) {
  if (cells.surface().is_flat()) return visit(CellRange{0, 0, 0, 0});
  const Vec2 at = triangle.cells(weights);
  const auto first = [](double x) { return std::int64_t(std::floor(x - edge_tolerance)); };
  const auto last = [](double x) { return std::int64_t(std::floor(x + edge_tolerance)); };
  for (std::int64_t j = first(at[1]); j <= last(at[1]); ++j) {
    for (std::int64_t i = first(at[0]); i <= last(at[0]); ++i) visit(CellRange{i, i, j, j});
  }
}

// The part of a triangle that is in one cell.
BarycentricPolygon clip_to_cell(const ReliefTriangle& t, const CellRange& one, bool is_flat) {
  BarycentricPolygon out = BarycentricPolygon::triangle();
  if (is_flat) return out;
  const std::array<double, 2> low = {double(one.i0), double(one.j0)};
  for (int axis = 0; axis < 2; ++axis) {
    const Vec2 slope(t.cell_a[axis], t.cell_b[axis]);
    const double offset = t.cell[axis] - low[std::size_t(axis)];
    BarycentricPolygon outside, above, inside;
    out.split(slope, offset, outside, above);
    if (above.is_empty()) return above;
    above.split(slope, offset - 1, inside, outside);
    out = inside;
    if (out.is_empty()) return out;
  }
  return out;
}

// Whether the distance to p falls from `weights` in some direction, over the pieces of a triangle there.
bool has_descent(const ReliefMesh& relief, int index, const Vec2& weights, const Vec3& point, const Vec3& p) {
  const ReliefTriangle triangle = relief.triangle(index);
  const CellGrid& cells = relief.cells();
  bool found = false;
  for_each_cell(cells, triangle, weights, [&](const CellRange& one) {
    if (found) return;
    const BarycentricPolygon outline = clip_to_cell(triangle, one, cells.surface().is_flat());
    if (outline.is_empty()) return;
    const ReliefPiece::Jet jet = cells.piece(triangle, outline, one).at(weights);
    if ((jet.point - point).norm() > tear_tolerance * relief.texel_size()) return;
    const Vec3 offset = jet.point - p;
    for (const Vec2& corner : outline) {
      const Vec2 to = corner - weights;
      const Vec3 way = to[0] * jet.by_a + to[1] * jet.by_b;
      found = found || offset.dot(way) < -min_descent_sine * offset.norm() * way.norm();
    }
  });
  return found;
}

// Calls visit(triangle, weights) for all triangles that contain a point, given by one of them: for that one
// only, if the point is inside it.
template <class Visit>
void for_each_around(const ReliefMesh& relief, int triangle, const Vec2& weights, const Visit& visit) {
  const Vec3 all = barycentric(weights);
  visit(triangle, weights);
  const VertexTriangles& vertices = relief.vertex_triangles();
  // All triangles that contain the place have a corner whose weight is not zero in common.
  int common = -1;
  bool is_inside = true;
  for (int k = 0; k < 3; ++k) {
    if (all[k] <= edge_tolerance)
      is_inside = false;
    else
      common = k;
  }
  if (is_inside || common < 0) return;
  for (const int other : vertices.triangles_at(vertices.vertex(triangle, common))) {
    if (other == triangle) continue;
    Vec3 theirs = Vec3::Zero();
    bool contains = true;
    for (int k = 0; k < 3 && contains; ++k) {
      if (all[k] <= edge_tolerance) continue;
      const int corner = vertices.corner_at(other, vertices.vertex(triangle, k));
      contains = corner >= 0;
      if (contains) theirs[corner] = all[k];
    }
    if (contains) visit(other, Vec2(theirs[1], theirs[2]));
  }
}

}  // namespace

bool is_local_minimum(const ReliefMesh& relief, const MeshFeature& feature, const Vec3& p) {
  bool out = true;
  for_each_around(relief, feature.triangle, feature.weights, [&](int triangle, const Vec2& weights) {
    out = out && !has_descent(relief, triangle, weights, feature.point, p);
  });
  return out;
}

SurfacePlace canonical_place(const ReliefMesh& relief, int triangle, const Vec2& weights) {
  SurfacePlace out{triangle, weights};
  for_each_around(relief, triangle, weights, [&](int other, const Vec2& theirs) {
    if (other < out.triangle) out = {other, theirs};
  });
  return out;
}

bool is_beyond_border(const ReliefMesh& relief, int triangle, const Vec2& weights, const Vec3& away) {
  if (barycentric(weights).minCoeff() > edge_tolerance) return false;
  bool on_border = false;
  for_each_around(relief, triangle, weights, [&](int other, const Vec2& theirs) {
    const Vec3 w = barycentric(theirs);
    for (int corner = 0; corner < 3; ++corner)
      on_border =
          on_border || (w[corner] <= edge_tolerance && relief.vertex_triangles().is_border(other, corner));
  });
  if (!on_border) return false;
  const Vec3 n = relief.triangle(triangle).normal(weights);
  // The relief may be of any slope there; over its border `away` has a part across the normal.
  const Vec3 sideways = away - away.dot(n) * n;
  return sideways.norm() > 1e-6 * away.norm();
}

}  // namespace intaglio::surface
