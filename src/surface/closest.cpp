#include "surface/closest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "surface/closest_search.h"
#include "surface/surface.h"

namespace intaglio::surface {

namespace {

constexpr double converged =
    1e-8;  // step in cells; convergence is quadratic, so the error is about its square

double clamp01(double f) {
  return std::min(std::max(f, 0.0), 1.0);
}

PatchPoint point_at(const LocalPatch& p, double s, double t) {
  return {s, t, p.at(s, t).squaredNorm()};
}

// Gradient and Hessian of half the squared distance at (s, t).
struct Derivatives {
  double g_s, g_t, h_ss, h_tt, h_st;

  Derivatives(const LocalPatch& p, double s, double t) {
    const double z_s = p.z_s(t), z_t = p.z_t(s);
    const Vec3 d = p.at(s, t);
    g_s = d.x() * p.w + d.z() * z_s;
    g_t = d.y() * p.h + d.z() * z_t;
    h_ss = p.w * p.w + z_s * z_s;
    h_tt = p.h * p.h + z_t * z_t;
    h_st = z_s * z_t + d.z() * p.twist;
  }
  double determinant() const { return h_ss * h_tt - h_st * h_st; }
  double newton_s() const { return -(h_tt * g_s - h_st * g_t) / determinant(); }
  double newton_t() const { return -(h_ss * g_t - h_st * g_s) / determinant(); }
};

// For a patch on which the squared distance is convex, so that a point that satisfies the optimality
// conditions is the nearest. Empty if the iteration does not converge (rare).
std::optional<PatchPoint> nearest_convex(const LocalPatch& p) {
  double s = clamp01(-p.x / p.w), t = clamp01(-p.y / p.h);
  for (int iteration = 0; iteration < 12; ++iteration) {
    const Derivatives d(p, s, t);
    const bool s_held = (s <= 0 && d.g_s >= 0) || (s >= 1 && d.g_s <= 0);
    const bool t_held = (t <= 0 && d.g_t >= 0) || (t >= 1 && d.g_t <= 0);
    if (s_held && t_held) return point_at(p, s, t);
    const double from_s = s, from_t = t;
    bool is_clipped = false;
    if (s_held) {
      t = clamp01(t - d.g_t / d.h_tt);
    } else if (t_held) {
      s = clamp01(s - d.g_s / d.h_ss);
    } else {
      const double to_s = s + d.newton_s(), to_t = t + d.newton_t();
      s = clamp01(to_s);
      t = clamp01(to_t);
      is_clipped = s != to_s || t != to_t;
      // The step crossed an edge: minimise along that edge.
      if (s != to_s) {
        t = p.nearest_t(s);
      } else if (t != to_t) {
        s = p.nearest_s(t);
      }
    }
    // After a clipped step the next round has to check the conditions.
    if (!is_clipped && std::abs(s - from_s) + std::abs(t - from_t) < converged) return point_at(p, s, t);
  }
  return std::nullopt;
}

PatchPoint nearest_on_outline(const LocalPatch& p) {
  PatchPoint best = point_at(p, p.nearest_s(0), 0);
  const auto consider = [&](double s, double t) {
    const PatchPoint other = point_at(p, s, t);
    if (other.distance2 < best.distance2) best = other;
  };
  consider(p.nearest_s(1), 1);
  consider(0, p.nearest_t(0));
  consider(1, p.nearest_t(1));
  return best;
}

struct Bounds {
  double low, high;
  double max_abs() const { return std::max(-low, high); }
  double min_abs() const { return std::max(std::max(low, -high), 0.0); }
};

Bounds between(double a, double b) {
  return {std::min(a, b), std::max(a, b)};
}

enum class Curvature { convex, indefinite, mixed };

Curvature curvature(const LocalPatch& p) {
  const double z1 = p.z + p.a, z2 = p.z + p.b, z3 = z1 + p.z_t(1);
  const Bounds z{std::min(std::min(p.z, z1), std::min(z2, z3)),
                 std::max(std::max(p.z, z1), std::max(z2, z3))};
  const double twist = std::abs(p.twist);
  if (twist * z.max_abs() < p.w * p.h) return Curvature::convex;
  // Otherwise bound each term.
  const Bounds z_s = between(p.a, p.z_s(1)), z_t = between(p.b, p.z_t(1));
  const Bounds q = between(p.twist * z.low, p.twist * z.high);
  const Bounds same_ends = between(z_s.low * z_t.low, z_s.high * z_t.high),
               cross_ends = between(z_s.low * z_t.high, z_s.high * z_t.low);
  const Bounds h_st{q.low + std::min(same_ends.low, cross_ends.low),
                    q.high + std::max(same_ends.high, cross_ends.high)};
  const auto product = [&](double s, double t) { return (p.w * p.w + s * s) * (p.h * p.h + t * t); };
  if (h_st.max_abs() * h_st.max_abs() < product(z_s.min_abs(), z_t.min_abs())) return Curvature::convex;
  if (h_st.min_abs() * h_st.min_abs() > product(z_s.max_abs(), z_t.max_abs())) return Curvature::indefinite;
  return Curvature::mixed;
}

// Improves on `best` within one patch, in its own s and t; false when nothing is nearer. Subdivision does not
// help where the Hessian is singular: after ten levels a piece is 1/1024 of a side, and its outline close
// enough.
bool refine(const LocalPatch& p, PatchPoint& best, int depth_left) {
  const Curvature kind = curvature(p);
  if (kind == Curvature::convex) {
    if (const auto found = nearest_convex(p)) {
      if (found->distance2 >= best.distance2) return false;
      best = *found;
      return true;
    }
  }
  bool improved = false;
  const PatchPoint outline = nearest_on_outline(p);
  if (outline.distance2 < best.distance2) {
    best = outline;
    improved = true;
  }
  if (kind == Curvature::indefinite || depth_left == 0) return improved;
  for (int k = 0; k < 4; ++k) {
    const LocalPatch quarter = p.quarter(k);
    if (quarter.farther_than(std::sqrt(best.distance2)) || !refine(quarter, best, depth_left - 1)) continue;
    best.s = 0.5 * (best.s + (k & 1));
    best.t = 0.5 * (best.t + (k >> 1));
    improved = true;
  }
  return improved;
}

}  // namespace

LocalPatch::LocalPatch(const Cell& cell, const Vec3& p)
    : LocalPatch(cell.x0 - p.x(), cell.y0 - p.y(), cell.width(), cell.height(), cell.z[0] - p.z(),
                 cell.z[1] - p.z(), cell.z[2] - p.z(), cell.z[3] - p.z()) {}

double LocalPatch::nearest_s(double t) const {
  const double slope = z_s(t);
  return clamp01(-(x * w + (z + t * b) * slope) / (w * w + slope * slope));
}

double LocalPatch::nearest_t(double s) const {
  const double slope = z_t(s);
  return clamp01(-(y * h + (z + s * a) * slope) / (h * h + slope * slope));
}

LocalPatch LocalPatch::quarter(int k) const {
  const double s = 0.5 * (k & 1), t = 0.5 * (k >> 1);
  const Vec3 corner = at(s, t);
  LocalPatch q = *this;
  q.x = corner.x();
  q.y = corner.y();
  q.z = corner.z();
  q.w = 0.5 * w;
  q.h = 0.5 * h;
  q.a = 0.5 * z_s(t);
  q.b = 0.5 * z_t(s);
  q.twist = 0.25 * twist;
  return q;
}

PatchPoint nearest(const LocalPatch& patch) {
  PatchPoint best{0, 0, std::numeric_limits<double>::infinity()};
  refine(patch, best, 10);
  return best;
}

namespace {

// The plane z = 0.
Feature closest_on_plane(const Surface& surface, const Vec3& p) {
  const auto [i, j] = surface.cell_at(p.x(), p.y());
  return {{p.x(), p.y(), 0}, Vec3::UnitZ(), p.z(), i, j};
}

double side_of(const Surface& surface, const Vec3& p) {
  return p.z() < -surface.depth(surface.placement().uv(p)) ? -1.0 : 1.0;
}

}  // namespace

std::optional<Feature> closest_point(const Surface& surface, const Vec3& p) {
  if (!p.allFinite()) return std::nullopt;
  if (surface.is_flat()) return closest_on_plane(surface, p);
  const double sign = side_of(surface, p);
  return ClosestSearch(surface, p, sign, std::numeric_limits<double>::infinity(), 0, false).next({});
}

std::size_t closest_features(const Surface& surface, const Vec3& p, double reach, double min_angle,
                             std::span<Feature> out) {
  if (out.empty() || !p.allFinite() || !(reach > 0)) return 0;
  if (surface.is_flat()) {
    out[0] = closest_on_plane(surface, p);
    return std::abs(p.z()) < reach ? 1 : 0;
  }
  const double sign = side_of(surface, p);
  ClosestSearch search(surface, p, sign, reach, min_angle, out.size() > 1);
  for (std::size_t count = 0; count < out.size(); ++count) {
    const auto feature = search.next(out.first(count));
    if (!feature) return count;
    out[count] = *feature;
  }
  return out.size();
}

}  // namespace intaglio::surface
