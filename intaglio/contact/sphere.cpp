#include "intaglio/contact/sphere.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "intaglio/contact/collision_point.h"
#include "intaglio/surface/closest.h"

namespace intaglio::contact {

namespace {

constexpr double min_angle = 20 * std::numbers::pi / 180;

std::uint64_t feature_id(int i, int j) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(j)) << 32) | static_cast<std::uint32_t>(i);
}

// A single contact with the base plane, before any texture changes it.
bool touches_plane(const surface::Surface& surface, const Sphere& sphere, double margin, Vec3& local,
                   ContactPoint& contact) {
  const surface::Placement& place = surface.placement();
  local = place.to_local(sphere.centre);
  if (!local.allFinite() || !place.covers(local) || local.z() - sphere.radius > margin ||
      local.z() < -sphere.radius)
    return false;
  contact.uv = place.uv(local);
  contact.distance = local.z() - sphere.radius;
  contact.normal = place.n();
  contact.n_s = surface.world_normal(contact.uv);
  contact.point = place.to_world({local.x(), local.y(), 0});
  return true;
}

}  // namespace

ContactSet relief_contacts(const surface::Surface& surface, const Sphere& sphere, double margin) {
  ContactSet set;
  const surface::Placement& place = surface.placement();
  const Vec3 local = place.to_local(sphere.centre);
  if (!local.allFinite() || local.z() - sphere.radius > margin) return set;
  std::array<surface::Feature, ContactSet::capacity> features;
  const std::size_t found = closest_features(surface, local, sphere.radius + margin, min_angle, features);
  for (std::size_t k = 0; k < found; ++k) {
    const surface::Feature& feature = features[k];
    if (!place.covers(feature.point)) continue;  // the texture goes on, the rectangle does not
    const Vec2 uv = place.uv(feature.point);
    set.points[set.count++] = {place.to_world(feature.point),
                               place.direction_to_world(feature.direction),
                               surface.world_normal(uv),
                               feature.distance - sphere.radius,
                               uv,
                               feature_id(feature.cell_i, feature.cell_j)};
  }
  return set;
}

ContactSet directional_contacts(const surface::Surface& surface, const Sphere& sphere, double margin) {
  ContactSet set;
  const surface::Placement& place = surface.placement();
  const Vec3 local = place.to_local(sphere.centre);
  const double r = sphere.radius;
  if (!local.allFinite() || !place.covers(local) || local.z() - r > margin) return set;
  std::array<ContactPoint, 4> deepest;
  std::array<bool, 4> found{};
  const auto [i0, j0] = surface.cell_at(local.x() - r, local.y() - r);
  const auto [i1, j1] = surface.cell_at(local.x() + r, local.y() + r);
  for (int j = j0; j <= j1 + 1; ++j) {
    for (int i = i0; i <= i1 + 1; ++i) {
      const double x = (i + 0.5) * surface.texel_u();
      const double y = (j + 0.5) * surface.texel_v();
      const double across2 = (x - local.x()) * (x - local.x()) + (y - local.y()) * (y - local.y());
      if (across2 >= r * r || x < 0 || y < 0 || x > place.size_u() || y > place.size_v()) continue;
      const double body_height = local.z() - std::sqrt(r * r - across2);
      const double distance = body_height - surface.texel_z(i, j);
      const auto quadrant = static_cast<std::size_t>((x > local.x() ? 1 : 0) + (y > local.y() ? 2 : 0));
      if (distance > margin || (found[quadrant] && distance >= deepest[quadrant].distance)) continue;
      found[quadrant] = true;
      const Vec2 uv = place.uv({x, y, 0});
      const Vec3 n_s = surface.world_normal(uv);
      deepest[quadrant] = {
          place.to_world({x, y, surface.texel_z(i, j)}), n_s, n_s, distance, uv, feature_id(i, j)};
    }
  }
  for (std::size_t q = 0; q < deepest.size(); ++q) {
    if (found[q]) set.points[set.count++] = deepest[q];
  }
  std::sort(set.points.begin(), set.points.begin() + static_cast<std::ptrdiff_t>(set.count),
            [](const ContactPoint& a, const ContactPoint& b) { return a.distance < b.distance; });
  return set;
}

ContactSet normal_map_contacts(const surface::Surface& surface, const Sphere& sphere, double margin) {
  ContactSet set;
  ContactPoint contact;
  Vec3 local;
  if (!touches_plane(surface, sphere, margin, local, contact)) return set;
  contact.normal = contact.n_s;
  contact.point = sphere_contact_point(sphere.centre, sphere.radius, contact.n_s);
  set.points[set.count++] = contact;
  return set;
}

ContactSet flat_contacts(const surface::Surface& surface, const Sphere& sphere, double margin) {
  ContactSet set;
  ContactPoint contact;
  Vec3 local;
  if (!touches_plane(surface, sphere, margin, local, contact)) return set;
  contact.n_s = contact.normal;
  set.points[set.count++] = contact;
  return set;
}

}  // namespace intaglio::contact
