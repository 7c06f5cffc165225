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

Vec3 ViewCamera::rotated(const Vec3& direction, double dx, double dy) const {
  constexpr double steepest = 0.49 * std::numbers::pi;
  const double length = direction.norm();
  const double azimuth = std::atan2(direction.x(), direction.z()) - dx;
  const double rise =
      std::clamp(std::asin(std::clamp(direction.y() / length, -1.0, 1.0)) + dy, -steepest, steepest);
  return length *
         Vec3(std::cos(rise) * std::sin(azimuth), std::sin(rise), std::cos(rise) * std::cos(azimuth));
}

void ViewCamera::orbit(double dx, double dy) {
  camera_.eye =
      camera_.target + rotated(camera_.eye - camera_.target, std::numbers::pi * dx, std::numbers::pi * dy);
}

void ViewCamera::look(double dx, double dy) {
  camera_.target = camera_.eye + rotated(camera_.target - camera_.eye, dx, -dy);
}

void ViewCamera::pan(double dx, double dy) {
  const double height = 2 * distance() * std::tan(0.5 * camera_.fov_y_degrees * std::numbers::pi / 180);
  const Vec3 step = height * (dy * right().cross(forward()) - dx * right());
  camera_.eye += step;
  camera_.target += step;
}

void ViewCamera::zoom(double notches) {
  const Vec3 out = camera_.eye - camera_.target;
  const double wanted = std::clamp(out.norm() * std::pow(0.9, notches), 0.02, 0.8 * camera_.far);
  camera_.eye = camera_.target + wanted * out.normalized();
}

void ViewCamera::fly(const Vec3& step) {
  const Vec3 moved = distance() * (step.x() * right() + step.y() * Vec3::UnitY() + step.z() * forward());
  camera_.eye += moved;
  camera_.target += moved;
}

Projection::Projection(const render::Camera& camera, double aspect_)
    : eye(camera.eye),
      tan_half_fov(std::tan(0.5 * camera.fov_y_degrees * std::numbers::pi / 180)),
      aspect(aspect_),
      near(camera.near) {
  const render::CameraBasis basis = render::basis_of(camera);
  right = basis.right;
  up = basis.up;
  forward = -basis.back;
}

std::optional<Vec2> Projection::project(const Vec3& world) const {
  const Vec3 to = world - eye;
  const double depth = to.dot(forward);
  if (depth < near) return std::nullopt;
  return Vec2(0.5 + 0.5 * to.dot(right) / (depth * tan_half_fov * aspect),
              0.5 - 0.5 * to.dot(up) / (depth * tan_half_fov));
}

Vec3 Projection::ray(const Vec2& place) const {
  return (forward + (2 * place.x() - 1) * tan_half_fov * aspect * right +
          (1 - 2 * place.y()) * tan_half_fov * up)
      .normalized();
}

namespace {

constexpr double no_hit = std::numeric_limits<double>::infinity();

double ray_sphere(double radius, const Vec3& o, const Vec3& d) {
  const double along = -o.dot(d), miss = o.squaredNorm() - along * along;
  if (miss > radius * radius) return no_hit;
  const double t = along - std::sqrt(radius * radius - miss);
  return t > 0 ? t : no_hit;
}

double ray_box(const Vec3& half, const Vec3& o, const Vec3& d) {
  double enter = 0, leave = no_hit;
  for (int k = 0; k < 3; ++k) {
    if (std::abs(d[k]) < 1e-12) {
      if (std::abs(o[k]) > half[k]) return no_hit;
      continue;
    }
    const double a = (-half[k] - o[k]) / d[k], b = (half[k] - o[k]) / d[k];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave && enter > 0 ? enter : no_hit;
}

double ray_shape(const contact::Shape& shape, const Vec3& o, const Vec3& d) {
  if (const auto* s = std::get_if<contact::Sphere>(&shape)) return ray_sphere(s->radius, o, d);
  if (const auto* s = std::get_if<contact::Box>(&shape)) return ray_box(s->half, o, d);
  if (const auto* s = std::get_if<contact::Cylinder>(&shape))
    return ray_box({s->radius, s->half_height, s->radius}, o, d);
  if (const auto* s = std::get_if<contact::Capsule>(&shape))
    return ray_box({s->radius, s->half_height + s->radius, s->radius}, o, d);
  if (const auto* s = std::get_if<contact::Compound>(&shape)) {
    double nearest = no_hit;
    for (const contact::CompoundChild& child : *s->children)
      nearest = std::min(
          nearest, ray_shape(child.shape, child.pose.to_local(o), child.pose.orientation.conjugate() * d));
    return nearest;
  }
  return ray_sphere(contact::bounding_radius(shape), o, d);
}

}  // namespace

std::optional<Picked> pick_body(const scene::Scene& scene, std::span<const Pose> poses, const Vec3& origin,
                                const Vec3& direction) {
  Picked best{floor_body, Vec3::Zero(), no_hit};
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Vec3 o = poses[k].to_local(origin), d = poses[k].orientation.conjugate() * direction;
    const std::size_t balls = scene.balls.size();
    const double t = k < balls ? ray_sphere(scene.balls[k].radius, o, d)
                               : ray_shape(scene.bodies[k - balls].body.shape, o, d);
    if (t < best.distance) best = {BodyId(k + 1), origin + t * direction, t};
  }
  if (best.body == floor_body) return std::nullopt;
  return best;
}

std::optional<Vec3> pick_floor(const surface::Surface& floor, bool use_relief, const Vec3& origin,
                               const Vec3& direction) {
  const surface::Placement& place = floor.placement();
  const Vec3 o = place.to_local(origin), d = place.direction_to_local(direction);
  if (use_relief && floor.has_depth())
    if (const auto hit = surface::intersect(floor, o, d, 0, 1e3)) return place.to_world(hit->point);
  if (std::abs(d.z()) < 1e-9) return std::nullopt;
  const double t = -o.z() / d.z();
  if (t <= 0 || t > 1e3) return std::nullopt;
  return origin + t * direction;
}

std::optional<PickedBase> pick_base(const surface::TriangleMesh& base, const Vec3& origin,
                                    const Vec3& direction) {
  std::optional<PickedBase> best;
  double nearest = no_hit;
  for (const surface::Triangle& t : base.triangles) {
    const auto at = [&](std::size_t k) { return std::size_t(t[k]); };
    const Vec3 &a = base.positions[at(0)], &b = base.positions[at(1)], &c = base.positions[at(2)];
    const Vec3 area_normal = (b - a).cross(c - a);
    const double facing = -area_normal.dot(direction);
    if (!(facing > 0)) continue;
    const double s = (origin - a).dot(area_normal) / facing;
    if (!(s > 0) || s >= nearest) continue;
    const Vec3 p = origin + s * direction;
    const double area = area_normal.squaredNorm(), v = (p - a).cross(c - a).dot(area_normal) / area,
                 w = (b - a).cross(p - a).dot(area_normal) / area;
    if (v < 0 || w < 0 || v + w > 1) continue;
    nearest = s;
    best = {
        p,
        ((1 - v - w) * base.normals[at(0)] + v * base.normals[at(1)] + w * base.normals[at(2)]).normalized()};
  }
  return best;
}

}  // namespace intaglio::window
