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

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "core/portable_math.h"
#include "intaglio/vec.h"
#include "surface/surface.h"

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

// Closest features of the relief to a point: the bilinear patches and the creases between them.
//
// Local coordinates (surface.h), metres; the relief repeats beyond its rectangle as the surface's edge mode
// says, and it is the caller who cares where the rectangle ends. Under wrap the copy of the texture under the
// point and the eight around it are searched: enough for the nearest point, always, and for features as long
// as `reach` is within a side.
//
// Exact; no allocation; any thread. A nearest-first descent of the pyramid, pruned by the best distance so
// far (closest_search.h). Cost at 512 x 512, within 5 cm of a brick wall of 1 m (bench_surface):
// closest_point 1.2 to 1.5 us, closest_features of a ball that touches 4 to 5 us; at 4096 x 4096 three to
// four times that.

struct Feature {
  Vec3 point = Vec3::Zero();      // on the relief, local
  Vec3 direction = Vec3::Zero();  // unit, from the relief outwards to the asking point (its mirror image when
                                  // that is below the relief)
  double distance = 0;            // signed: negative when the asking point is below the relief
  int cell_i = 0, cell_j = 0;     // which patch
};

// The point of the relief that is nearest to p, wherever p is. Nothing only when p is not finite.
std::optional<Feature> closest_point(const Surface& surface, const Vec3& p);

// Local minima of the distance from p to the relief that are nearer than `reach` and turn their outer side to
// p, nearest first; of two whose directions differ by less than `min_angle` (radians, in 0..pi / 2, not
// 0) only the nearer is kept. A cell offers its nearest point only. Returns how many were written to `out`.
// All come from one descent: what the nearest made needless is kept and looked at again for the next, unless
// it lies wholly within min_angle of a feature already found; so flat ground costs little more than
// closest_point.
std::size_t closest_features(const Surface& surface, const Vec3& p, double reach, double min_angle,
                             std::span<Feature> out);

// The directions around features already found, as seen from the asking point: what lies in them is not
// wanted again. Internal to surface/; on the stack, no allocation.

class Cones {
 public:
  // `sign` is 1 for an asking point above the relief, -1 below; min_angle in radians.
  Cones(std::span<const Feature> found, double sign, double min_angle)
      : found_(found), sign_(sign), cos_(elementary::cos(min_angle)), sin_(elementary::sin(min_angle)) {}

  bool empty() const { return found_.empty(); }
  std::size_t size() const { return found_.size(); }
  double cosine() const { return cos_; }
  Vec3 axis(std::size_t k) const { return -sign_ * found_[k].direction; }  // from the asking point

  // Whether a feature of this direction is in one.
  bool hold(const Vec3& direction) const {
    return std::any_of(found_.begin(), found_.end(),
                       [&](const Feature& f) { return f.direction.dot(direction) > cos_; });
  }
  // Whether a ball, its centre as seen from the asking point, is wholly within one cone. False when that is
  // not certain.
  bool hold_ball(const Vec3& centre, double radius) const {
    const double distance2 = centre.squaredNorm();
    // The ball looks asin(radius / distance) wide, and its centre must be that much inside the cone;
    // min_angle < 90 degrees.
    if (cos_ <= 0 || radius * radius >= sin_ * sin_ * distance2) return false;
    // distance * cos(min_angle - asin(radius / distance))
    const double needed = cos_ * std::sqrt(distance2 - radius * radius) + sin_ * radius;
    return std::any_of(found_.begin(), found_.end(),
                       [&](const Feature& f) { return -sign_ * f.direction.dot(centre) > needed; });
  }

 private:
  std::span<const Feature> found_;
  double sign_, cos_, sin_;
};

}  // namespace intaglio::surface
