#include "window/view_camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "surface/ray.h"

namespace intaglio::window {

ViewCamera::ViewCamera(const render::Camera& start) : start_(start), camera_(start) {
  const double far = std::max(50.0, 10 * (start.target - start.eye).norm());
  camera_.far = start_.far = far;
}

Vec3 ViewCamera::turned(const Vec3& direction, double across, double up) const {
  constexpr double steepest = 0.49 * std::numbers::pi;
  const double length = direction.norm();
  const double azimuth = std::atan2(direction.x(), direction.z()) - across;
  const double rise =
      std::clamp(std::asin(std::clamp(direction.y() / length, -1.0, 1.0)) + up, -steepest, steepest);
  return length *
         Vec3(std::cos(rise) * std::sin(azimuth), std::sin(rise), std::cos(rise) * std::cos(azimuth));
}

void ViewCamera::orbit(double across, double up) {
  camera_.eye =
      camera_.target + turned(camera_.eye - camera_.target, std::numbers::pi * across, std::numbers::pi * up);
}

void ViewCamera::look(double across, double up) {
  camera_.target = camera_.eye + turned(camera_.target - camera_.eye, across, -up);
}

void ViewCamera::pan(double across, double up) {
  const double height = 2 * distance() * std::tan(0.5 * camera_.fov_y_degrees * std::numbers::pi / 180);
  const Vec3 step = height * (up * right().cross(ahead()) - across * right());
  camera_.eye += step;
  camera_.target += step;
}

void ViewCamera::zoom(double notches) {
  const Vec3 out = camera_.eye - camera_.target;
  const double wanted = std::clamp(out.norm() * std::pow(0.9, notches), 0.02, 0.8 * camera_.far);
  camera_.eye = camera_.target + wanted * out.normalized();
}

void ViewCamera::fly(const Vec3& step) {
  const Vec3 moved = distance() * (step.x() * right() + step.y() * Vec3::UnitY() + step.z() * ahead());
  camera_.eye += moved;
  camera_.target += moved;
}

Projection::Projection(const render::Camera& camera, double aspect_)
    : eye(camera.eye),
      ahead((camera.target - camera.eye).normalized()),
      tangent(std::tan(0.5 * camera.fov_y_degrees * std::numbers::pi / 180)),
      aspect(aspect_),
      near(camera.near) {
  const bool up_is_lost = camera.up.cross(ahead).norm() < 1e-9;
  right = ahead.cross(up_is_lost ? Vec3(-Vec3::UnitZ()) : camera.up).normalized();
  up = right.cross(ahead);
}

std::optional<Vec2> Projection::project(const Vec3& world) const {
  const Vec3 to = world - eye;
  const double depth = to.dot(ahead);
  if (depth < near) return std::nullopt;
  return Vec2(0.5 + 0.5 * to.dot(right) / (depth * tangent * aspect),
              0.5 - 0.5 * to.dot(up) / (depth * tangent));
}

Vec3 Projection::ray(const Vec2& place) const {
  return (ahead + (2 * place.x() - 1) * tangent * aspect * right + (1 - 2 * place.y()) * tangent * up)
      .normalized();
}

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

std::optional<Picked> pick_body(const scene::Scene& scene, std::span<const Pose> poses, const Vec3& origin,
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
