// The point of one bilinear patch that is nearest to a point.
//
// Lengths in metres. Pure, any thread, no allocation. Exact: what is found satisfies the conditions of
// optimality of a convex function, or is on an edge, where the squared distance is a parabola. Only one term
// can spoil convexity over the patch, q = twist * dz: the Hessian of half the squared distance is h_ss = w^2
// + z_s^2, h_tt = h^2 + z_t^2, h_st = z_s z_t + q, and h_ss h_tt - h_st^2 >= (w h)^2 - q^2 by the inequality
// of means.
//   convex everywhere:     projected Newton.
//   indefinite everywhere: no minimum inside, so the four edges.
//   neither (seldom):      the patch is cut in four, what is farther than the best so far is left out, and so
//   on.
#pragma once

#include <cmath>

#include "intaglio/core/vec.h"

namespace intaglio::surface {

struct Cell;

// Whether a parallelogram (sides (w, 0, z_s) and (0, h, z_t) around `middle`) is certainly `distance` away
// from the origin or more. Half the squared distance is convex over it, hence above its tangent at the
// middle: a bound sharp to second order in the size, where the box around a tilted piece is so to first order
// only.
inline bool parallelogram_beyond(const Vec3& middle, double w, double h, double z_s, double z_t,
                                 double distance) {
  const double g_s = middle.x() * w + middle.z() * z_s, g_t = middle.y() * h + middle.z() * z_t;
  return middle.squaredNorm() - std::abs(g_s) - std::abs(g_t) >= distance * distance;
}

// A patch as its asking point sees it: the asking point is the origin.
// Point at (s, t): (x + s w, y + t h, z + s a + t b + s t twist).
struct SeenPatch {
  double x, y, z;
  double w, h;
  double a, b, twist;

  SeenPatch(const Cell& cell, const Vec3& p);
  SeenPatch(double x0, double y0, double width, double height, double z0, double z1, double z2, double z3)
      : x(x0), y(y0), z(z0), w(width), h(height), a(z1 - z0), b(z2 - z0), twist(z3 - z2 - z1 + z0) {}

  double z_s(double t) const { return a + t * twist; }
  double z_t(double s) const { return b + s * twist; }
  Vec3 at(double s, double t) const { return {x + s * w, y + t * h, z + s * a + t * z_t(s)}; }
  // Nearest s of the line t = const, limited to 0..1; the squared distance is a parabola there. And the other
  // way round.
  double nearest_s(double t) const;
  double nearest_t(double s) const;
  // Whether the whole patch is certainly `distance` away or more.
  bool beyond(double distance) const {
    const double z_s = a + 0.5 * twist, z_t = b + 0.5 * twist;
    const Vec3 middle(x + 0.5 * w, y + 0.5 * h, z + 0.5 * (a + b) + 0.25 * twist);
    return parallelogram_beyond(middle, w, h, z_s, z_t,
                                distance + 0.25 * std::abs(twist));  // the patch is that, give or take
  }
  // Quarter k: the half k & 1 along s of the half k >> 1 along t.
  SeenPatch quarter(int k) const;
};

struct NearestOnPatch {
  double s, t;
  double distance2;
};

NearestOnPatch nearest(const SeenPatch& patch);

// The point of a cell that is nearest to p, as (s, t) in 0..1.
Vec2 closest_on_cell(const Cell& cell, const Vec3& p);

}  // namespace intaglio::surface
