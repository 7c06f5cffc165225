#include "intaglio/window/view_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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

}  // namespace intaglio::window
