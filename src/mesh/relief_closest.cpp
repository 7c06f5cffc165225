#include "mesh/relief_closest.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh/relief_minimum.h"
#include "surface/closest.h"

namespace intaglio::surface {

namespace {

constexpr std::size_t most_features = 6;

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
template <class Core>
class Nearest {
 public:
  Nearest(const Core& core, double limit) : core_(core), limit_(limit) {}

  double limit() const { return limit_; }
  double least(const Box& box) const { return core_.least(box); }
  double least(const FlatPiece& piece) const { return core_.least(piece); }
  void visit(const ReliefPiece& piece) {
    PieceMinimiser<Core> minimiser(piece, core_, value_of(limit_));
    if (!minimiser.run()) return;
    limit_ = Core::distance(minimiser.best().value);
    value_ = minimiser.best().value;
    found_ = feature_of(piece, minimiser.best().weights);
    base_normal_ = piece.base_normal(minimiser.best().weights);
    normal_ = normal_of(piece, minimiser.best().weights);
  }
  const std::optional<MeshFeature>& found() const { return found_; }
  const Vec3& base_normal() const { return base_normal_; }
  const Vec3& normal() const { return normal_; }

 private:
  // So that what was found first is not found again beside an edge, a hair nearer by rounding.
  double value_of(double limit) const {
    if (found_) return value_ - 1e-14 * std::abs(value_);
    return std::is_same_v<Core, PlaneCore> ? limit : 0.5 * limit * limit;
  }

  const Core& core_;
  double limit_, value_ = 0;
  std::optional<MeshFeature> found_;
  Vec3 base_normal_ = Vec3::Zero(), normal_ = Vec3::Zero();
};

// Sets sign, distance and direction of a feature whose asking point is at `away` from it.
void turn(const ReliefMesh& relief, const Vec3& away, const Vec3& base_normal, const Vec3& normal,
          MeshFeature& feature) {
  const double distance = away.norm();
  if (distance <= 1e-12 * relief.texel()) {
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
  NextNearest(const ReliefMesh& relief, const PointCore& core, double limit, const Cones& cones)
      : relief_(relief), core_(core), limit_(limit), cones_(cones) {}

  double limit() const { return limit_; }
  double least(const Box& box) const { return core_.least(box); }
  double least(const FlatPiece& piece) const {
    const double least = core_.least(piece);
    if (least < limit_ && cones_.contains_ball(piece.middle - core_.centre, piece.radius()))
      return std::numeric_limits<double>::infinity();
    return least;
  }
  void visit(const ReliefPiece& piece) {
    PieceMinimiser<PointCore> minimiser(piece, core_, 0.5 * limit_ * limit_);
    if (!minimiser.run()) return;
    const Vec2 weights = minimiser.best().weights;
    const double distance = PointCore::distance(minimiser.best().value);
    const Vec3 away = core_.centre - piece.point(weights);
    if (distance == 0 || away.dot(piece.base_normal(weights)) <= 0 || cones_.contains(away / distance)) return;
    MeshFeature next = feature_of(piece, weights);
    if (!is_local_minimum(relief_, next, core_.centre)) return;
    next.distance = distance;
    next.direction = away / distance;
    found_ = next;
    limit_ = distance;
  }
  const std::optional<MeshFeature>& found() const { return found_; }

 private:
  const ReliefMesh& relief_;
  const PointCore& core_;
  double limit_;
  const Cones& cones_;
  std::optional<MeshFeature> found_;
};

// The lowest piece that is not near those found before.
class Lowest {
 public:
  Lowest(const PlaneCore& core, double limit, std::span<const MeshFeature> others, double apart)
      : core_(core), limit_(limit), others_(others), apart_(apart) {}

  double limit() const { return limit_; }
  double least(const Box& box) const { return core_.least(box); }
  double least(const FlatPiece& piece) const {
    if (!others_.empty() && is_near(piece.middle, apart_ - piece.radius()))
      return std::numeric_limits<double>::infinity();
    return core_.least(piece);
  }
  void visit(const ReliefPiece& piece) {
    PieceMinimiser<PlaneCore> minimiser(piece, core_, limit_);
    if (!minimiser.run()) return;
    const Vec2 weights = minimiser.best().weights;
    if (is_near(piece.point(weights), apart_)) return;
    limit_ = minimiser.best().value;
    found_ = feature_of(piece, weights);
    found_->distance = limit_;
    found_->direction = -core_.normal;
  }
  const std::optional<MeshFeature>& found() const { return found_; }

 private:
  bool is_near(const Vec3& point, double within) const {
    return std::any_of(others_.begin(), others_.end(),
                       [&](const MeshFeature& other) { return (other.point - point).norm() < within; });
  }

  const PlaneCore& core_;
  double limit_;
  std::span<const MeshFeature> others_;
  double apart_;
  std::optional<MeshFeature> found_;
};

}  // namespace

std::optional<MeshFeature> closest_point(const ReliefMesh& relief, const Vec3& p, double reach) {
  if (!p.allFinite() || !(reach > 0)) return std::nullopt;
  const PointCore core{p};
  Nearest<PointCore> nearest(core, reach);
  relief.walk(nearest);
  std::optional<MeshFeature> out = nearest.found();
  if (out) turn(relief, p - out->point, nearest.base_normal(), nearest.normal(), *out);
  return out;
}

std::size_t closest_features(const ReliefMesh& relief, const Vec3& p, double reach, double min_angle,
                             std::span<MeshFeature> out) {
  if (out.empty()) return 0;
  const auto first = closest_point(relief, p, reach);
  if (!first) return 0;
  out[0] = *first;
  if (first->distance <= 0) return 1;
  const PointCore core{p};
  std::array<Feature, most_features> found;
  std::size_t count = 0;
  const auto keep = [&](const MeshFeature& feature) {
    found[count].direction = feature.direction;
    out[count++] = feature;
  };
  keep(*first);
  const std::size_t most = std::min(out.size(), most_features);
  while (count < most) {
    const Cones cones(std::span<const Feature>(found).first(count), 1, min_angle);
    NextNearest next(relief, core, reach, cones);
    relief.walk(next);
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
  const SegmentCore core{from, along / length, length};
  Nearest<SegmentCore> nearest(core, reach);
  relief.walk(nearest);
  std::optional<MeshFeature> out = nearest.found();
  if (out) {
    turn(relief, core.nearest(out->point) - out->point, nearest.base_normal(), nearest.normal(), *out);
  }
  return out;
}

std::optional<MeshFeature> lowest_point(const ReliefMesh& relief, const Vec3& normal, double offset,
                                        double below, std::span<const MeshFeature> others, double apart) {
  if (!normal.allFinite() || !std::isfinite(offset)) return std::nullopt;
  const PlaneCore core{normal, offset};
  Lowest lowest(core, below, others, apart);
  relief.walk(lowest);
  return lowest.found();
}

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
