// The minimum of a convex function of space on one piece of a relief.
//
// The function f is half the squared distance from a point or a segment, or the height over a plane. On the
// piece it is F(a, b) = f(X(a, b)), whose derivatives are exact (ReliefPiece::Jet):
//   F_a  = grad f . X_a
//   F_ab = X_a . H X_b + grad f . X_ab,   H the Hessian of f.
// H has no negative eigenvalue, so only the second term, the curvature of the piece against the direction of
// f, can make F bend down and have several minima. The search looks at the Hessian of F at the corners and
// the centroid of the piece, and assumes that it has the same definiteness everywhere on the piece:
//
//   positive definite at all of them:  F is convex. Newton's method from the centroid finds its only
//       minimum. If that is inside the piece, it is the answer. If it is outside, the minimum over the
//       piece is on an edge that it lies beyond: from any other point of the piece, the straight way to it
//       begins inside the piece, and F falls along it. Only those edges are searched.
//   indefinite at all of them:  some direction bends down everywhere, so a minimum cannot be inside; all
//       edges are searched.
//   else:  all edges are searched, Newton's method is tried for a minimum inside, and the piece is halved,
//       up to 6 times, as long as its linear bound is below the best so far.
//
// Along an edge F has one variable. If it falls at the beginning and rises at the end, Newton's method, kept
// inside by bisection, finds a minimum between; the ends themselves have been sampled before.
//
// Newton's method where the Hessian is not positive definite: along a segment H lacks the segment's own
// direction e, H = I - e e^T. Adding e e^T back gives the Hessian of the distance from a point, an upper
// bound with the same gradient, whose steps are shorter but go down. Where that is not positive definite
// either, there is no minimum near.
//
// No allocation; any thread; about 0.3 us a piece.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "mesh/relief_mesh.h"
#include "mesh/relief_piece.h"

namespace intaglio::surface {

// Value, gradient and Hessian of a function at a point.
struct Derivatives {
  double value;
  Vec3 gradient;
  // The Hessian is curvature * (I - flat flat^T).
  Vec3 flat;  // unit, or zero
  double curvature;

  double hessian(const Vec3& u, const Vec3& v) const {
    return curvature * (u.dot(v) - flat.dot(u) * flat.dot(v));
  }
};

// Distance from a point, metres; the function is half its square.
struct PointDistance {
  Vec3 centre;

  Derivatives at(const Vec3& x) const {
    const Vec3 offset = x - centre;
    return {0.5 * offset.squaredNorm(), offset, Vec3::Zero(), 1};
  }
  static double distance(double value) { return std::sqrt(2 * value); }
  static double value(double distance) { return 0.5 * distance * distance; }
  double lower_bound(const Bounds& box) const { return std::sqrt(box.squaredExteriorDistance(centre)); }
  double lower_bound(const LinearPiece& piece) const {
    const Vec3 offset = piece.middle - centre;
    const double d = offset.norm();
    return d == 0 ? -piece.error : d + piece.min_along(offset / d) - piece.error;
  }
};

// Distance from a segment, metres; the function is half its square.
struct SegmentDistance {
  Vec3 from, along;  // unit
  double length;

  Vec3 nearest(const Vec3& x) const { return from + std::clamp(along.dot(x - from), 0.0, length) * along; }
  Derivatives at(const Vec3& x) const {
    const double s = along.dot(x - from);
    const Vec3 offset = x - (from + std::clamp(s, 0.0, length) * along);
    return {0.5 * offset.squaredNorm(), offset, s > 0 && s < length ? along : Vec3(Vec3::Zero()), 1};
  }
  static double distance(double value) { return std::sqrt(2 * value); }
  static double value(double distance) { return 0.5 * distance * distance; }
  double lower_bound(const Bounds& box) const {
    const Vec3 to = from + length * along;
    const Bounds own(from.cwiseMin(to), from.cwiseMax(to));
    return std::sqrt(box.squaredExteriorDistance(own));
  }
  double lower_bound(const LinearPiece& piece) const {
    const Vec3 offset = piece.middle - nearest(piece.middle);
    const double d = offset.norm();
    return d == 0 ? -piece.error - piece.radius() : d + piece.min_along(offset / d) - piece.error;
  }
};

// Height over a plane, metres: may be negative.
struct PlaneDistance {
  Vec3 normal;
  double offset;

  Derivatives at(const Vec3& x) const { return {normal.dot(x) - offset, normal, Vec3::Zero(), 0}; }
  static double distance(double value) { return value; }
  static double value(double distance) { return distance; }
  double lower_bound(const Bounds& box) const {
    return normal.dot(box.center()) - 0.5 * normal.cwiseAbs().dot(box.sizes()) - offset;
  }
  double lower_bound(const LinearPiece& piece) const {
    return normal.dot(piece.middle) - offset + piece.min_along(normal) - piece.error;
  }
};

struct ReliefMinimum {
  double value;  // of the function
  Vec2 weights;
};

template <class DistanceFrom>
class PieceMinimiser {
 public:
  PieceMinimiser(const ReliefPiece& piece, const DistanceFrom& from, double limit)
      : piece_(piece), from_(from), best_{limit, Vec2::Zero()} {}

  // Whether there is anything below the limit.
  bool run() {
    const double before = best_.value;
    search(piece_.outline, max_subdivisions);
    return best_.value < before;
  }
  const ReliefMinimum& best() const { return best_; }

 private:
  // F at a point: value, gradient, Hessian.
  struct Sample {
    double value;
    Vec2 gradient;
    double aa, ab, bb;
    double extra_aa, extra_ab,
        extra_bb;  // of curvature * flat flat^T: added, the Hessian of a point distance

    bool is_convex() const { return aa > 0 && aa * bb - ab * ab > 1e-14 * aa * bb; }
    // F bends down along some direction: no minimum inside.
    bool is_indefinite() const { return aa < 0 || bb < 0 || aa * bb - ab * ab < -1e-12 * std::abs(aa * bb); }
    double along(const Vec2& d) const { return aa * d[0] * d[0] + 2 * ab * d[0] * d[1] + bb * d[1] * d[1]; }
  };
  using Samples = std::array<Sample, BarycentricPolygon::max_corners>;

  // Also keeps the best so far; evaluate_quietly does not: a point off the piece must not count as a result.
  Sample evaluate(const Vec2& at) {
    const Sample out = evaluate_quietly(at);
    if (out.value < best_.value) best_ = {out.value, at};
    return out;
  }
  Sample evaluate_quietly(const Vec2& at) const {
    const ReliefPiece::Jet jet = piece_.at(at);
    const Derivatives f = from_.at(jet.point);
    const Vec3 second = jet.second_along(f.gradient);
    const double a = f.flat.dot(jet.by_a), b = f.flat.dot(jet.by_b);
    return {f.value,
            {f.gradient.dot(jet.by_a), f.gradient.dot(jet.by_b)},
            f.hessian(jet.by_a, jet.by_a) + second[0],
            f.hessian(jet.by_a, jet.by_b) + second[1],
            f.hessian(jet.by_b, jet.by_b) + second[2],
            f.curvature * a * a,
            f.curvature * a * b,
            f.curvature * b * b};
  }

  void search(const BarycentricPolygon& outline, int subdivisions) {
    const Vec2 centroid = outline.centroid();
    Samples corners;
    const Sample centre = evaluate(centroid);
    bool convex = centre.is_convex(), indefinite = centre.is_indefinite();
    for (std::size_t k = 0; k < outline.size(); ++k) {
      corners[k] = evaluate(outline[k]);
      convex = convex && corners[k].is_convex();
      indefinite = indefinite && corners[k].is_indefinite();
    }
    Vec2 lowest = centroid;
    const bool has_converged = !indefinite && newton(outline, lowest, centre);
    const bool only_beyond = has_converged && convex;
    bool is_inside = has_converged;
    for (std::size_t k = 0; k < outline.size(); ++k) {
      const bool beyond = is_beyond(outline, k, lowest);
      if (beyond || !only_beyond) search_edge(outline, corners, k);
      is_inside = is_inside && !beyond;
    }
    if (is_inside) evaluate(lowest);
    if (!only_beyond && !indefinite && subdivisions > 0) subdivide(outline, subdivisions);
  }

  static bool is_beyond(const BarycentricPolygon& outline, std::size_t k, const Vec2& at) {
    const Vec2 from = outline[k], along = outline[outline.after(k)] - from, offset = at - from;
    return along[0] * offset[1] - along[1] * offset[0] < 0;
  }

  // Newton's method from the centroid. A step that goes up is halved, since the Hessian jumps across the end
  // of a segment. Stops far outside: only the direction is needed. Whether it converged.
  bool newton(const BarycentricPolygon& outline, Vec2& at, Sample here) const {
    double size = 0;
    for (const Vec2& corner : outline) size = std::max(size, (corner - at).cwiseAbs().maxCoeff());
    const Vec2 start = at;
    for (int iteration = 0; iteration < 30; ++iteration) {
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
      // Limit the step: along a segment the Hessian is nearly singular.
      step *= std::min(1.0, size / step.cwiseAbs().maxCoeff());
      const double rounding = 1e-15 * std::abs(here.value), before = here.value;
      for (int half = 0; half < 8; ++half) {
        here = evaluate_quietly(at + step);
        if (here.value <= before + rounding) break;
        step *= 0.5;
      }
      at += step;
      if ((at - start).cwiseAbs().maxCoeff() > 2 * size) return true;
    }
    return false;
  }

  void search_edge(const BarycentricPolygon& outline, const Samples& corners, std::size_t k) {
    const std::size_t next = outline.after(k);
    const Vec2 from = outline[k], along = outline[next] - from;
    double low = 0, high = 1;
    const double slope_low = corners[k].gradient.dot(along), slope_high = corners[next].gradient.dot(along);
    // The ends have been evaluated; at a minimum between them the slope changes its sign.
    if (!(slope_low < 0 && slope_high > 0)) return;
    double s = slope_low / (slope_low - slope_high);
    for (int iteration = 0; iteration < 30; ++iteration) {
      const Sample here = evaluate(from + s * along);
      const double slope = here.gradient.dot(along);
      (slope < 0 ? low : high) = s;
      double step = s - slope / here.along(along);
      if (!(step > low && step < high)) step = 0.5 * (low + high);
      if (std::abs(step - s) <= 1e-14) return;
      s = step;
    }
  }

  // Halves the longer side in weights; searches the halves that may hold something lower.
  void subdivide(const BarycentricPolygon& outline, int subdivisions) {
    Vec2 low = outline[0], high = low;
    for (const Vec2& corner : outline) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
    ReliefPiece whole = piece_;
    whole.outline = outline;
    whole.for_each_half(high[0] - low[0] >= high[1] - low[1] ? Vec2(1, 0) : Vec2(0, 1),
                        [&](const ReliefPiece& half) {
                          if (from_.lower_bound(half.linear()) < DistanceFrom::distance(best_.value))
                            search(half.outline, subdivisions - 1);
                        });
  }

  static constexpr int max_subdivisions = 6;

  const ReliefPiece& piece_;
  const DistanceFrom& from_;
  ReliefMinimum best_;
};

}  // namespace intaglio::surface
