#include "dynamics/drawn.h"

#include <algorithm>
#include <cmath>

#include "contact/surface_contacts.h"
#include "intaglio/vec.h"
#include "surface/closest.h"

namespace intaglio::dynamics {

namespace {

// The gap between a body and a relief, negative when it is in it. No contact is farther than the relief is
// from the body's position.
double relief_gap(const surface::Surface& relief, const contact::Shape& shape, const Pose& pose) {
  const auto nearest = closest_point(relief, relief.placement().to_local(pose.position));
  if (!nearest) return 0;
  const contact::ContactSet set =
      contact::relief_contacts(relief, shape, pose, std::max(nearest->distance, 0.0) + 1e-6);
  // Overlap is small or a mistake: nothing is drawn deeper than by a hundredth of its size.
  const double reach = bounding_radius(shape);
  return set.count > 0 ? std::max(set.points[0].distance, -0.01 * reach) : nearest->distance - reach;
}

double flat_gap(const surface::Surface& map, const contact::Shape& shape, const Pose& pose) {
  const double height = map.placement().to_local(pose.position).z();
  const contact::ContactSet set = contact::flat_contacts(map, shape, pose, std::max(height, 0.0) + 1e-6);
  return set.count > 0 ? set.points[0].distance : height - bounding_radius(shape);
}

}  // namespace

Drawn::Drawn(const surface::Surface& map, const surface::Surface& relief, const Vec2& mean_slope)
    : map_(map), relief_(relief), mean_slope_(mean_slope) {
  const surface::Placement& place = map.placement();
  turned_back_ = rotation_onto(
      place.direction_to_world(Vec3(-mean_slope.x(), -mean_slope.y(), 1).normalized()), place.n());
}

Pose Drawn::pose(const contact::Shape& shape, const Pose& simulated) const {
  Pose out{simulated.position, (turned_back_ * simulated.orientation).normalized()};
  const double lift = relief_gap(relief_, shape, simulated) - flat_gap(map_, shape, out);
  out.position += lift * map_.placement().n();
  return out;
}

Vec3 Drawn::point(const Vec3& simulated) const {
  const surface::Placement& place = map_.placement();
  return simulated - place.to_local(simulated).z() * place.n();
}

Pose Drawn::simulated(const contact::Shape& shape, const Pose& drawn) const {
  const double gap = flat_gap(map_, shape, drawn);
  const Vec3 n = map_.placement().n();
  Pose out{drawn.position, (turned_back_.conjugate() * drawn.orientation).normalized()};
  // Lowered from above all of the relief, each time by as much as is surely free.
  out.position +=
      (bounding_radius(shape) + std::max(gap, 0.0) - relief_.placement().to_local(drawn.position).z()) * n;
  for (int k = 0; k < 100; ++k) {
    const double excess = relief_gap(relief_, shape, out) - gap;
    out.position -= excess * n;
    if (std::abs(excess) < 1e-9) break;
  }
  return out;
}

Vec3 Drawn::velocity(const Vec3& simulated) const {
  const surface::Placement& place = map_.placement();
  const Vec3 local = place.direction_to_local(simulated);
  return simulated - mean_slope_.dot(local.head<2>()) * place.n();
}

Vec3 Drawn::simulated_velocity(const Vec3& drawn) const {
  const surface::Placement& place = map_.placement();
  const Vec3 local = place.direction_to_local(drawn);
  return drawn + mean_slope_.dot(local.head<2>()) * place.n();
}

}  // namespace intaglio::dynamics
