#include "intaglio/surface/mesh/relief_closest.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "intaglio/surface/cones.h"
#include "intaglio/surface/mesh/relief_minimum.h"
#include "intaglio/surface/mesh/relief_rim.h"

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
    if (least < limit_ && cones_.hold_ball(piece.middle - core_.centre, piece.radius()))
      return std::numeric_limits<double>::infinity();
    return least;
  }
  void visit(const ReliefPiece& piece) {
    PieceMinimiser<PointCore> minimiser(piece, core_, 0.5 * limit_ * limit_);
    if (!minimiser.run()) return;
    const Vec2 weights = minimiser.best().weights;
    const double distance = PointCore::distance(minimiser.best().value);
    const Vec3 away = core_.centre - piece.point(weights);
    if (distance == 0 || away.dot(piece.base_normal(weights)) <= 0 || cones_.hold(away / distance)) return;
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

}  // namespace intaglio::surface
