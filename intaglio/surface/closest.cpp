#include "intaglio/surface/closest.h"

#include <cmath>
#include <limits>

#include "intaglio/surface/closest_search.h"

namespace intaglio::surface {

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
