// Where a convex function of space is least on one piece of a relief.
//
// A Core is what the distance is measured from: a point, a segment, a plane. Its function is convex, so only
// the curvature of the piece can make several minima. At every corner of the piece and in its middle the
// Hessian is looked at: where it is positive everywhere Newton's method finds the one minimum, and when that
// is outside, the minimum is on an edge that it is beyond; elsewhere all edges are searched and the piece is
// cut in two, and again. No allocation; any thread; about 0.3 us a piece.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "mesh/relief_piece.h"

namespace intaglio::surface {

// What a core says at a point: value, gradient, and what the Hessian makes of two directions.
struct CoreSlope {
  double value;
  Vec3 gradient;
  Vec3 along;  // unit, or zero: no curvature along it
  double curvature;

  double bend(const Vec3& u, const Vec3& v) const {
    return curvature * (u.dot(v) - along.dot(u) * along.dot(v));
  }
};

// Distance from a point, metres.
struct PointCore {
  Vec3 centre;

  // Half the distance squared.
  CoreSlope at(const Vec3& x) const {
    const Vec3 away = x - centre;
    return {0.5 * away.squaredNorm(), away, Vec3::Zero(), 1};
  }
  static double distance(double value) { return std::sqrt(2 * value); }
  double least(const Box& box) const { return std::sqrt(box.squaredExteriorDistance(centre)); }
  double least(const FlatPiece& piece) const {
    const Vec3 away = piece.middle - centre;
    const double d = away.norm();
    return d == 0 ? -piece.play : d + piece.least_along(away / d) - piece.play;
  }
};

// Distance from a segment, metres.
struct SegmentCore {
  Vec3 from, along;  // unit
  double length;

  Vec3 nearest(const Vec3& x) const { return from + std::clamp(along.dot(x - from), 0.0, length) * along; }
  CoreSlope at(const Vec3& x) const {
    const double s = along.dot(x - from);
    const Vec3 away = x - (from + std::clamp(s, 0.0, length) * along);
    return {0.5 * away.squaredNorm(), away, s > 0 && s < length ? along : Vec3(Vec3::Zero()), 1};
  }
  static double distance(double value) { return std::sqrt(2 * value); }
  double least(const Box& box) const {
    const Vec3 to = from + length * along;
    const Box own(from.cwiseMin(to), from.cwiseMax(to));
    return std::sqrt(box.squaredExteriorDistance(own));
  }
  double least(const FlatPiece& piece) const {
    const Vec3 away = piece.middle - nearest(piece.middle);
    const double d = away.norm();
    return d == 0 ? -piece.play - piece.radius() : d + piece.least_along(away / d) - piece.play;
  }
};

// Height over a plane, metres: may be negative.
struct PlaneCore {
  Vec3 normal;
  double offset;

  CoreSlope at(const Vec3& x) const { return {normal.dot(x) - offset, normal, Vec3::Zero(), 0}; }
  static double distance(double value) { return value; }
  double least(const Box& box) const {
    return normal.dot(box.center()) - 0.5 * normal.cwiseAbs().dot(box.sizes()) - offset;
  }
  double least(const FlatPiece& piece) const {
    return normal.dot(piece.middle) - offset + piece.least_along(normal) - piece.play;
  }
};

struct ReliefMinimum {
  double value;  // as the core's
  Vec2 weights;
};

template <class Core>
class PieceMinimiser {
 public:
  PieceMinimiser(const ReliefPiece& piece, const Core& core, double limit)
      : piece_(piece), core_(core), best_{limit, Vec2::Zero()} {}

  // Whether there is anything below the limit.
  bool run() {
    const double before = best_.value;
    search(piece_.outline, most_cuts);
    return best_.value < before;
  }
  const ReliefMinimum& best() const { return best_; }

 private:
  struct Place {
    double value;
    Vec2 gradient;
    double aa, ab, bb;
    double extra_aa, extra_ab, extra_bb;  // more than that it bends nowhere: as if the core were a point

    bool is_convex() const { return aa > 0 && aa * bb - ab * ab > 1e-14 * aa * bb; }
    // Along some direction it bends down: no minimum inside.
    bool is_concave() const { return aa < 0 || bb < 0 || aa * bb - ab * ab < -1e-12 * std::abs(aa * bb); }
    double bend(const Vec2& d) const { return aa * d[0] * d[0] + 2 * ab * d[0] * d[1] + bb * d[1] * d[1]; }
  };

  Place look(const Vec2& at) {
    const ReliefPiece::Jet jet = piece_.at(at);
    const CoreSlope core = core_.at(jet.point);
    const Vec3 second = jet.second_along(core.gradient);
    const double a = core.curvature * core.along.dot(jet.by_a), b = core.along.dot(jet.by_b);
    const Place out{core.value,
                    {core.gradient.dot(jet.by_a), core.gradient.dot(jet.by_b)},
                    core.bend(jet.by_a, jet.by_a) + second[0],
                    core.bend(jet.by_a, jet.by_b) + second[1],
                    core.bend(jet.by_b, jet.by_b) + second[2],
                    a * a,
                    a * b,
                    core.curvature * b * b};
    if (out.value < best_.value) best_ = {out.value, at};
    return out;
  }

  void search(const WeightPolygon& outline, int cuts) {
    const Vec2 middle = outline.middle();
    std::array<Place, WeightPolygon::most_corners> corners;
    const Place centre = look(middle);
    bool convex = centre.is_convex(), concave = centre.is_concave();
    for (std::size_t k = 0; k < outline.size(); ++k) {
      corners[k] = look(outline[k]);
      convex = convex && corners[k].is_convex();
      concave = concave && corners[k].is_concave();
    }
    Vec2 lowest = middle;
    const bool arrived = !concave && descend(outline, lowest, centre);
    bool inside = arrived;
    if (arrived && convex) {
      for (std::size_t k = 0; k < outline.size(); ++k) {
        if (!is_beyond(outline, k, lowest)) continue;
        inside = false;
        search_edge(outline, corners, k);
      }
      if (inside) look(lowest);
      return;
    }
    for (std::size_t k = 0; k < outline.size(); ++k) {
      search_edge(outline, corners, k);
      inside = inside && !is_beyond(outline, k, lowest);
    }
    if (inside) look(lowest);
    if (concave || cuts == 0) return;
    cut(outline, middle, cuts);
  }

  static bool is_beyond(const WeightPolygon& outline, std::size_t k, const Vec2& at) {
    const Vec2 from = outline[k], along = outline[k + 1 < outline.size() ? k + 1 : 0] - from,
               away = at - from;
    return along[0] * away[1] - along[1] * away[0] < 0;
  }

  // Newton's method from the middle; a step that goes up is halved, for across the end of a segment the
  // Hessian jumps. Far outside of the piece it stops: the way there is what is asked. Whether it arrived.
  bool descend(const WeightPolygon& outline, Vec2& at, Place here) {
    double size = 0;
    for (const Vec2& corner : outline) size = std::max(size, (corner - at).cwiseAbs().maxCoeff());
    const Vec2 middle = at;
    for (int round = 0; round < 30; ++round) {
      double area = here.aa * here.bb - here.ab * here.ab;
      if (!(area > 0 && here.aa > 0)) {
        here.aa += here.extra_aa;
        here.ab += here.extra_ab;
        here.bb += here.extra_bb;
        area = here.aa * here.bb - here.ab * here.ab;
        if (!(area > 0 && here.aa > 0)) return false;
      }
      Vec2 step = Vec2(here.ab * here.gradient[1] - here.bb * here.gradient[0],
                       here.ab * here.gradient[0] - here.aa * here.gradient[1]) /
                  area;
      if (step.cwiseAbs().maxCoeff() <= 1e-13 * size) return true;
      // Along a valley the step may be endless, and past a segment's end the valley ends.
      step *= std::min(1.0, size / step.cwiseAbs().maxCoeff());
      const double rounding = 1e-15 * std::abs(here.value), before = here.value;
      for (int half = 0; half < 8; ++half) {
        here = look_outside(at + step);
        if (here.value <= before + rounding) break;
        step *= 0.5;
      }
      at += step;
      if ((at - middle).cwiseAbs().maxCoeff() > 2 * size) return true;
    }
    return false;
  }
  // The place of a step, which need not be on the piece: it is no answer.
  Place look_outside(const Vec2& at) {
    const ReliefMinimum kept = best_;
    const Place out = look(at);
    best_ = kept;
    return out;
  }

  void search_edge(const WeightPolygon& outline,
                   const std::array<Place, WeightPolygon::most_corners>& corners, std::size_t k) {
    const std::size_t next = k + 1 < outline.size() ? k + 1 : 0;
    const Vec2 from = outline[k], along = outline[next] - from;
    double low = 0, high = 1;
    const double slope_low = corners[k].gradient.dot(along), slope_high = corners[next].gradient.dot(along);
    // The ends have been looked at; a minimum between them has the slope change its sign.
    if (!(slope_low < 0 && slope_high > 0)) return;
    double s = slope_low / (slope_low - slope_high);
    for (int round = 0; round < 30; ++round) {
      const Place here = look(from + s * along);
      const double slope = here.gradient.dot(along), bend = here.bend(along);
      (slope < 0 ? low : high) = s;
      double step = s - slope / bend;
      if (!(step > low && step < high)) step = 0.5 * (low + high);
      if (std::abs(step - s) <= 1e-14) return;
      s = step;
    }
  }

  // Both halves, where something lower may be.
  void cut(const WeightPolygon& outline, const Vec2& middle, int cuts) {
    Vec2 low = outline[0], high = low;
    for (const Vec2& corner : outline) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
    const Vec2 across = high[0] - low[0] >= high[1] - low[1] ? Vec2(1, 0) : Vec2(0, 1);
    WeightPolygon below, above;
    outline.split(across, -across.dot(middle), below, above);
    for (const WeightPolygon& half : {below, above}) {
      if (half.is_empty()) continue;
      ReliefPiece part = piece_;
      part.outline = half;
      const Vec2 at = half.middle();
      if (core_.least(FlatPiece(piece_.triangle, half, part.heights(at), at)) < Core::distance(best_.value))
        search(half, cuts - 1);
    }
  }

  static constexpr int most_cuts = 6;

  const ReliefPiece& piece_;
  const Core& core_;
  ReliefMinimum best_;
};

}  // namespace intaglio::surface
