// Closest features of the relief to a point: the bilinear patches and the creases between them.
//
// Local coordinates (surface.h), metres. The relief repeats beyond its rectangle according to the surface's
// edge mode; the caller handles the rectangle's ends. Under wrap, the tile below the point and the eight
// around it are searched: always enough for the nearest point, and for features as long as `reach` is at most
// one side.
//
// Exact; no allocation; any thread. A nearest-first descent of the pyramid, pruned by the best distance so
// far (closest_search.h). Cost at 512 x 512, within 5 cm of a brick wall of 1 m (bench_surface):
// closest_point 1.2 to 1.5 us, closest_features of a ball that touches 4 to 5 us; at 4096 x 4096 three to
// four times that.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "core/portable_math.h"
#include "intaglio/vec.h"
#include "surface/surface.h"

namespace intaglio::surface {

struct Feature {
  Vec3 point = Vec3::Zero();  // on the relief, local
  // Unit, pointing out of the relief: towards the query point, or away from it when that is below the relief.
  Vec3 direction = Vec3::Zero();
  double distance = 0;         // signed: negative when the query point is below the relief
  int cell_i = 0, cell_j = 0;  // of its patch
};

// The point of the relief that is nearest to p. Empty only when p is not finite.
std::optional<Feature> closest_point(const Surface& surface, const Vec3& p);

// Local minima of the distance from p to the relief that are nearer than `reach` and whose upper side faces
// p, nearest first; of two whose directions differ by less than `min_angle` (radians, 0 < min_angle <= pi /
// 2) only the nearer is kept. Each cell contributes at most its nearest point. Returns the number written to
// `out`. All come from one descent: blocks pruned for the nearest feature are kept and re-examined for the
// next, unless they lie entirely within min_angle of a feature already found; flat ground therefore costs
// little more than closest_point.
std::size_t closest_features(const Surface& surface, const Vec3& p, double reach, double min_angle,
                             std::span<Feature> out);

// --- Internal to surface/ and mesh/ ---

// The nearest point of one bilinear patch.
//
// Exact: the result satisfies the optimality conditions of a convex function, or is on an edge, where the
// squared distance is a parabola. Convexity can fail through one term only, q = twist * dz. The Hessian of
// half the squared distance is
//   h_ss = w^2 + z_s^2,   h_tt = h^2 + z_t^2,   h_st = z_s z_t + q,
// so that, with |z_s z_t q| <= |q| (w^2 z_t^2 + h^2 z_s^2) / (2 w h) from the AM-GM inequality and |q| <= w
// h,
//   h_ss h_tt - h_st^2 = (w h)^2 - q^2 + w^2 z_t^2 + h^2 z_s^2 - 2 z_s z_t q >= (w h)^2 - q^2.
// Three cases, then:
//   convex everywhere:      projected Newton
//   indefinite everywhere:  no minimum inside, so the four edges
//   neither (rare):         quartered recursively; quarters farther than the best so far are skipped

// Whether a parallelogram with sides (w, 0, z_s) and (0, h, z_t) around `middle` is certainly at least
// `distance` from the origin. The squared distance is convex over it, hence above its tangent at the middle
// m:
//   |p|^2 >= |m|^2 + 2 (g_s ds + g_t dt) >= |m|^2 - |g_s| - |g_t|   for |ds|, |dt| <= 1/2.
// The bound is sharp to second order in the size, the box around a tilted piece only to first order.
inline bool parallelogram_farther_than(const Vec3& middle, double w, double h, double z_s, double z_t,
                                       double distance) {
  const double g_s = middle.x() * w + middle.z() * z_s, g_t = middle.y() * h + middle.z() * z_t;
  return middle.squaredNorm() - std::abs(g_s) - std::abs(g_t) >= distance * distance;
}

// A patch in coordinates whose origin is the query point.
// Point at (s, t): (x + s w, y + t h, z + s a + t b + s t twist).
struct LocalPatch {
  double x, y, z;
  double w, h;
  double a, b, twist;

  LocalPatch(const Cell& cell, const Vec3& p);
  LocalPatch(double x0, double y0, double width, double height, double z0, double z1, double z2, double z3)
      : x(x0), y(y0), z(z0), w(width), h(height), a(z1 - z0), b(z2 - z0), twist(z3 - z2 - z1 + z0) {}

  double z_s(double t) const { return a + t * twist; }
  double z_t(double s) const { return b + s * twist; }
  Vec3 at(double s, double t) const { return {x + s * w, y + t * h, z + s * a + t * z_t(s)}; }
  // The s in 0..1 that is nearest on the line t = const, where the squared distance is a parabola; and vice
  // versa.
  double nearest_s(double t) const;
  double nearest_t(double s) const;
  // Whether the entire patch is certainly at least `distance` away: it deviates from the parallelogram by
  // twist (s - 1/2) (t - 1/2), at most |twist| / 4.
  bool farther_than(double distance) const {
    const double z_s = a + 0.5 * twist, z_t = b + 0.5 * twist;
    const Vec3 middle(x + 0.5 * w, y + 0.5 * h, z + 0.5 * (a + b) + 0.25 * twist);
    return parallelogram_farther_than(middle, w, h, z_s, z_t, distance + 0.25 * std::abs(twist));
  }
  // Quarter k: the half k & 1 along s of the half k >> 1 along t.
  LocalPatch quarter(int k) const;
};

struct PatchPoint {
  double s, t;
  double distance2;
};

PatchPoint nearest(const LocalPatch& patch);

// Directions around features already found, seen from the query point: features inside them are rejected.
class Cones {
 public:
  // `sign` is 1 for a query point above the relief, -1 below; min_angle in radians.
  Cones(std::span<const Feature> found, double sign, double min_angle)
      : found_(found), sign_(sign), cos_(elementary::cos(min_angle)), sin_(elementary::sin(min_angle)) {}

  bool empty() const { return found_.empty(); }
  std::size_t size() const { return found_.size(); }
  double cosine() const { return cos_; }
  Vec3 axis(std::size_t k) const { return -sign_ * found_[k].direction; }  // from the query point

  // Whether a direction lies in any cone.
  bool contains(const Vec3& direction) const {
    return std::any_of(found_.begin(), found_.end(),
                       [&](const Feature& f) { return f.direction.dot(direction) > cos_; });
  }
  // Whether a ball, its centre relative to the query point, lies entirely within one cone. Conservative.
  bool contains_ball(const Vec3& centre, double radius) const {
    const double distance2 = centre.squaredNorm();
    // The ball subtends a half-angle asin(radius / distance), so its centre must lie that far inside the
    // cone: at distance * cos(min_angle - asin(radius / distance)) along the axis or more.
    if (cos_ <= 0 || radius * radius >= sin_ * sin_ * distance2) return false;
    const double needed = cos_ * std::sqrt(distance2 - radius * radius) + sin_ * radius;
    return std::any_of(found_.begin(), found_.end(),
                       [&](const Feature& f) { return -sign_ * f.direction.dot(centre) > needed; });
  }

 private:
  std::span<const Feature> found_;
  double sign_, cos_, sin_;
};

}  // namespace intaglio::surface
