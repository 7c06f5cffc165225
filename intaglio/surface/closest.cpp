#include "intaglio/surface/closest.h"

#include <algorithm>
#include <cmath>

namespace intaglio::surface {

namespace {

// Parameter in 0..1 of the point of segment a..b that is nearest to p.
double closest_on_segment(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3 d = b - a;
  const double length2 = d.squaredNorm();
  return length2 > 0 ? std::clamp(d.dot(p - a) / length2, 0.0, 1.0) : 0.0;
}

Vec2 closest_on_outline(const Cell& cell, const Vec3& p) {
  Vec2 best(0, 0);
  double best_distance2 = std::numeric_limits<double>::infinity();
  const auto consider = [&](const Vec2& a, const Vec2& b) {
    const double k = closest_on_segment(cell.at(a.x(), a.y()), cell.at(b.x(), b.y()), p);
    const Vec2 st = a + k * (b - a);
    const double distance2 = (cell.at(st.x(), st.y()) - p).squaredNorm();
    if (distance2 < best_distance2) {
      best_distance2 = distance2;
      best = st;
    }
  };
  consider({0, 0}, {1, 0});
  consider({0, 1}, {1, 1});
  consider({0, 0}, {0, 1});
  consider({1, 0}, {1, 1});
  return best;
}

// Newton's method for a stationary point of the squared distance inside the patch, from `start`. False when there is none near.
bool stationary_inside(const Cell& cell, const Vec3& p, Vec2& st) {
  const double w = cell.width();
  const double h = cell.height();
  const double a = cell.z[1] - cell.z[0];
  const double b = cell.z[2] - cell.z[0];
  const double twist = cell.z[3] - cell.z[2] - cell.z[1] + cell.z[0];
  for (int iteration = 0; iteration < 12; ++iteration) {
    const Vec3 d = cell.at(st.x(), st.y()) - p;
    const double z_s = a + twist * st.y();
    const double z_t = b + twist * st.x();
    const Vec2 gradient(d.x() * w + d.z() * z_s, d.y() * h + d.z() * z_t);
    const double h_ss = w * w + z_s * z_s;
    const double h_tt = h * h + z_t * z_t;
    const double h_st = z_s * z_t + d.z() * twist;
    const double determinant = h_ss * h_tt - h_st * h_st;
    if (determinant <= 1e-12 * h_ss * h_tt) return false;  // a saddle of the distance
    const Vec2 step(-(h_tt * gradient.x() - h_st * gradient.y()) / determinant, -(h_ss * gradient.y() - h_st * gradient.x()) / determinant);
    st += step;
    if (std::abs(st.x() - 0.5) > 1.5 || std::abs(st.y() - 0.5) > 1.5) return false;
    if (step.squaredNorm() < 1e-24) break;
  }
  return st.x() >= 0 && st.x() <= 1 && st.y() >= 0 && st.y() <= 1;
}

// Keeps `kept[0..count)` the nearest features of distinct directions, nearest first.
void keep(std::span<Feature> kept, std::size_t& count, const Feature& candidate, double cos_min_angle) {
  const auto alike = [&](const Feature& other) { return other.direction.dot(candidate.direction) > cos_min_angle; };
  for (std::size_t k = 0; k < count; ++k) {
    if (kept[k].distance <= candidate.distance && alike(kept[k])) return;
  }
  const auto end = std::remove_if(kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(count), alike);
  count = static_cast<std::size_t>(end - kept.begin());
  std::size_t at = count;
  while (at > 0 && kept[at - 1].distance > candidate.distance) --at;
  if (at == kept.size()) return;
  count = std::min(count + 1, kept.size());
  for (std::size_t k = count - 1; k > at; --k) kept[k] = kept[k - 1];
  kept[at] = candidate;
}

}  // namespace

Vec2 closest_on_cell(const Cell& cell, const Vec3& p) {
  Vec2 best = closest_on_outline(cell, p);
  double best_distance2 = (cell.at(best.x(), best.y()) - p).squaredNorm();
  const Vec2 over(std::clamp((p.x() - cell.x0) / cell.width(), 0.0, 1.0), std::clamp((p.y() - cell.y0) / cell.height(), 0.0, 1.0));
  for (Vec2 start : {over, Vec2(0.5, 0.5), best}) {
    if (!stationary_inside(cell, p, start)) continue;
    const double distance2 = (cell.at(start.x(), start.y()) - p).squaredNorm();
    if (distance2 < best_distance2) {
      best_distance2 = distance2;
      best = start;
    }
  }
  return best;
}

std::size_t closest_features(const Surface& surface, const Vec3& p, double reach, double min_angle, std::span<Feature> out) {
  if (out.empty() || !p.allFinite() || !(reach > 0)) return 0;
  const Vec2 uv = surface.placement().uv(p);
  const bool below = p.z() < -surface.depth(uv);
  const double sign = below ? -1.0 : 1.0;
  const double cos_min_angle = std::cos(min_angle);
  const double z_reach = below ? std::numeric_limits<double>::infinity() : p.z() - reach;
  const auto [i0, j0] = surface.cell_at(p.x() - reach, p.y() - reach);
  const auto [i1, j1] = surface.cell_at(p.x() + reach, p.y() + reach);
  std::size_t count = 0;
  for (int j = j0; j <= j1; ++j) {
    for (int i = i0; i <= i1; ++i) {
      const Cell cell = surface.cell(i, j);
      if (!below && cell.max_z() < z_reach) continue;
      const double dx = std::max({cell.x0 - p.x(), p.x() - cell.x1, 0.0});
      const double dy = std::max({cell.y0 - p.y(), p.y() - cell.y1, 0.0});
      const double dz = std::max({cell.min_z() - p.z(), p.z() - cell.max_z(), 0.0});
      if (dx * dx + dy * dy + dz * dz >= reach * reach) continue;
      const Vec2 st = closest_on_cell(cell, p);
      Feature feature{cell.at(st.x(), st.y()), Vec3::Zero(), 0, i, j};
      const Vec3 apart = p - feature.point;
      const double length = apart.norm();
      if (length >= reach) continue;
      feature.direction = length > 1e-12 ? Vec3(sign * apart / length) : cell.normal(st.x(), st.y());
      feature.distance = sign * length;
      // Below the relief the way out is the nearest feature: order by length, report the sign.
      if (below) feature.distance = length;
      keep(out, count, feature, cos_min_angle);
    }
  }
  if (below) {
    for (std::size_t k = 0; k < count; ++k) out[k].distance = -out[k].distance;
  }
  return count;
}

}  // namespace intaglio::surface
