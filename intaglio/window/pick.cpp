#include "intaglio/window/pick.h"

#include <cmath>
#include <limits>

#include "intaglio/surface/ray.h"

namespace intaglio::window {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

double meet_ball(double radius, const Vec3& o, const Vec3& d) {
  const double along = -o.dot(d), miss = o.squaredNorm() - along * along;
  if (miss > radius * radius) return never;
  const double t = along - std::sqrt(radius * radius - miss);
  return t > 0 ? t : never;
}

double meet_box(const Vec3& half, const Vec3& o, const Vec3& d) {
  double enter = 0, leave = never;
  for (int k = 0; k < 3; ++k) {
    if (std::abs(d[k]) < 1e-12) {
      if (std::abs(o[k]) > half[k]) return never;
      continue;
    }
    const double a = (-half[k] - o[k]) / d[k], b = (half[k] - o[k]) / d[k];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave && enter > 0 ? enter : never;
}

double meet(const contact::Shape& shape, const Vec3& o, const Vec3& d) {
  if (const auto* s = std::get_if<contact::Sphere>(&shape)) return meet_ball(s->radius, o, d);
  if (const auto* s = std::get_if<contact::Box>(&shape)) return meet_box(s->half, o, d);
  if (const auto* s = std::get_if<contact::Cylinder>(&shape))
    return meet_box({s->radius, s->half_height, s->radius}, o, d);
  if (const auto* s = std::get_if<contact::Capsule>(&shape))
    return meet_box({s->radius, s->half_height + s->radius, s->radius}, o, d);
  if (const auto* s = std::get_if<contact::Compound>(&shape)) {
    double nearest = never;
    for (const contact::CompoundChild& child : *s->children)
      nearest = std::min(nearest,
                         meet(child.shape, child.pose.to_local(o), child.pose.orientation.conjugate() * d));
    return nearest;
  }
  return meet_ball(contact::bounding_radius(shape), o, d);
}

}  // namespace

std::optional<Picked> pick_body(const session::Scene& scene, std::span<const Pose> poses, const Vec3& origin,
                                const Vec3& direction) {
  Picked best{floor_body, Vec3::Zero(), never};
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Vec3 o = poses[k].to_local(origin), d = poses[k].orientation.conjugate() * direction;
    const std::size_t balls = scene.balls.size();
    const double t =
        k < balls ? meet_ball(scene.balls[k].radius, o, d) : meet(scene.bodies[k - balls].body.shape, o, d);
    if (t < best.distance) best = {static_cast<BodyId>(k + 1), origin + t * direction, t};
  }
  if (best.body == floor_body) return std::nullopt;
  return best;
}

std::optional<Vec3> pick_floor(const surface::Surface& floor, bool has_relief, const Vec3& origin,
                               const Vec3& direction) {
  const surface::Placement& place = floor.placement();
  const Vec3 o = place.to_local(origin), d = place.direction_to_local(direction);
  if (has_relief && floor.has_depth())
    if (const auto hit = surface::intersect(floor, o, d, 0, 1e3)) return place.to_world(hit->point);
  if (std::abs(d.z()) < 1e-9) return std::nullopt;
  const double t = -o.z() / d.z();
  if (t <= 0 || t > 1e3) return std::nullopt;
  return origin + t * direction;
}

std::optional<PickedBase> pick_base(const surface::TriangleMesh& base, const Vec3& origin,
                                    const Vec3& direction) {
  std::optional<PickedBase> best;
  double nearest = never;
  for (const surface::Triangle& t : base.triangles) {
    const auto at = [&](std::size_t k) { return static_cast<std::size_t>(t[k]); };
    const Vec3 &a = base.positions[at(0)], &b = base.positions[at(1)], &c = base.positions[at(2)];
    const Vec3 across = (b - a).cross(c - a);
    const double facing = -across.dot(direction);
    if (!(facing > 0)) continue;
    const double s = (origin - a).dot(across) / facing;
    if (!(s > 0) || s >= nearest) continue;
    const Vec3 p = origin + s * direction;
    const double area = across.squaredNorm(), v = (p - a).cross(c - a).dot(across) / area,
                 w = (b - a).cross(p - a).dot(across) / area;
    if (v < 0 || w < 0 || v + w > 1) continue;
    nearest = s;
    best = {
        p,
        ((1 - v - w) * base.normals[at(0)] + v * base.normals[at(1)] + w * base.normals[at(2)]).normalized()};
  }
  return best;
}

}  // namespace intaglio::window
