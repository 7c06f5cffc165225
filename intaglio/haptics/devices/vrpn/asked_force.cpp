#include "intaglio/haptics/devices/vrpn/asked_force.h"

#include <algorithm>

#include "intaglio/haptics/force.h"

namespace intaglio::haptics::vrpn {

// a x + b y + c z + d = 0 with a normal of any length. Doubles hold the squares of any float.
static Plane unit_plane(const PlaneMessage& message) {
  const Vec3 normal(message.a, message.b, message.c);
  const double length = normal.norm();
  return {normal / length, -message.d / length};
}

void AskedForce::set(const PlaneMessage& plane) {
  auto& place = planes_[static_cast<std::size_t>(plane.index)];
  place = plane.off() ? std::nullopt : std::optional(plane);
}

void AskedForce::set(const ForceField& field) {
  const bool nothing = field.force.isZero(0) && field.jacobian.isZero(0);
  field_ = nothing ? std::nullopt : std::optional(field);
}

void AskedForce::clear() {
  *this = AskedForce(units_);
}

bool AskedForce::any() const {
  return !force_.isZero(0) || field_ ||
         std::any_of(planes_.begin(), planes_.end(), [](const auto& plane) { return plane.has_value(); });
}

Vec3 AskedForce::newtons(const Vec3& x, const Vec3& v) const {
  Vec3 sum = force_;
  for (const auto& plane : planes_) {
    if (!plane) continue;
    const Spring spring{std::max(0.0, units_.stiffness * plane->kspring),
                        std::max(0.0, units_.damping * plane->kdamp)};
    sum += plane_force(unit_plane(*plane), spring, x, v);
  }
  if (field_) {
    const Vec3 from_origin = x - field_->origin.cast<double>();
    if (from_origin.norm() <= field_->radius)
      sum += field_->force.cast<double>() + field_->jacobian.cast<double>() * from_origin;
  }
  return sum;
}

std::optional<Vec3> AskedForce::contact(const Vec3& x) const {
  std::optional<Vec3> point;
  double deepest = 0;
  for (const auto& message : planes_) {
    if (!message) continue;
    const Plane plane = unit_plane(*message);
    const double depth = -plane.distance(x);
    if (depth <= deepest) continue;
    deepest = depth;
    point = x + depth * plane.normal;
  }
  return point;
}

}  // namespace intaglio::haptics::vrpn
