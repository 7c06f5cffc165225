#include "intaglio/surface/ray.h"

#include <algorithm>
#include <cmath>

namespace intaglio::surface {

namespace {

// Narrows [t0, t1] to where origin + t direction is within [low, high]; false when nothing is left.
bool clip(double origin, double direction, double low, double high, double& t0, double& t1) {
  if (direction == 0) return origin >= low && origin <= high;
  double a = (low - origin) / direction;
  double b = (high - origin) / direction;
  if (a > b) std::swap(a, b);
  t0 = std::max(t0, a);
  t1 = std::min(t1, b);
  return t0 <= t1;
}

// Smallest t in [t0, t1] at which the ray is on the patch. Height above the patch is q(t) = A t^2 + B t + C.
std::optional<double> hit_patch(const Cell& cell, const Vec3& o, const Vec3& d, double t0, double t1) {
  const double s0 = (o.x() - cell.x0) / cell.width();
  const double s1 = d.x() / cell.width();
  const double r0 = (o.y() - cell.y0) / cell.height();
  const double r1 = d.y() / cell.height();
  const double a = cell.z[1] - cell.z[0];
  const double b = cell.z[2] - cell.z[0];
  const double twist = cell.z[3] - cell.z[2] - cell.z[1] + cell.z[0];
  const double A = -twist * s1 * r1;
  const double B = d.z() - a * s1 - b * r1 - twist * (s0 * r1 + s1 * r0);
  const double C = o.z() - cell.z[0] - a * s0 - b * r0 - twist * s0 * r0;
  const double tolerance = 1e-12 * (1 + std::abs(t1));
  std::optional<double> best;
  const auto consider = [&](double t) {
    if (t >= t0 - tolerance && t <= t1 + tolerance && (!best || t < *best)) best = t;
  };
  if (std::abs(A) < 1e-14 * std::max(std::abs(B), 1e-300)) {
    if (B != 0) consider(-C / B);
    return best;
  }
  const double discriminant = B * B - 4 * A * C;
  if (discriminant < 0) return best;
  const double q = -0.5 * (B + std::copysign(std::sqrt(discriminant), B));
  consider(q / A);
  if (q != 0) consider(C / q);
  return best;
}

}  // namespace

std::optional<RayHit> intersect(const Surface& surface, const Vec3& origin, const Vec3& direction, double t_min, double t_max) {
  if (!origin.allFinite() || !direction.allFinite() || direction.squaredNorm() == 0) return std::nullopt;
  const Placement& place = surface.placement();
  double t0 = t_min;
  double t1 = t_max;
  if (!clip(origin.x(), direction.x(), 0, place.size_u(), t0, t1) || !clip(origin.y(), direction.y(), 0, place.size_v(), t0, t1) ||
      !clip(origin.z(), direction.z(), -surface.max_depth() * (1 + 1e-9) - 1e-12, 1e-12, t0, t1)) {
    return std::nullopt;
  }
  // Walk the cells under the ray in order (Amanatides and Woo, 1987).
  const Vec3 start = origin + t0 * direction;
  auto [i, j] = surface.cell_at(start.x(), start.y());
  const int step_i = direction.x() > 0 ? 1 : -1;
  const int step_j = direction.y() > 0 ? 1 : -1;
  double t = t0;
  for (int visited = 0; visited <= 2 * (surface.width() + surface.height()) && t <= t1; ++visited) {
    const Cell cell = surface.cell(i, j);
    const double t_x = direction.x() != 0 ? ((step_i > 0 ? cell.x1 : cell.x0) - origin.x()) / direction.x() : t1 + 1;
    const double t_y = direction.y() != 0 ? ((step_j > 0 ? cell.y1 : cell.y0) - origin.y()) / direction.y() : t1 + 1;
    const double leave = std::min({t_x, t_y, t1});
    if (const auto hit = hit_patch(cell, origin, direction, t, leave); hit && *hit >= t_min) {
      const Vec3 point = origin + *hit * direction;
      return RayHit{*hit, point, cell.normal((point.x() - cell.x0) / cell.width(), (point.y() - cell.y0) / cell.height())};
    }
    if (t_x <= t_y) {
      i += step_i;
    } else {
      j += step_j;
    }
    t = std::max(t, leave);
    if (leave >= t1) break;
  }
  return std::nullopt;
}

}  // namespace intaglio::surface
