#include "intaglio/surface/mesh/mesh_shapes.h"

#include <cassert>
#include <cmath>
#include <functional>
#include <numbers>

#include "intaglio/core/elementary.h"

namespace intaglio::surface {

namespace {

// A point of the curve that is turned about the Y axis, with its normal in the same plane.
struct Profile {
  double radius, y;
  double normal_radius, normal_y;
};

enum class Turn {
  east = 1,
  west = -1
};  // the way in which u goes around, seen from +Y: east is counter-clockwise

// A row has one vertex more than it has quads: the seam is stored once for u = 0 and once for u = 1. At a
// pole the triangles have one corner each, in the middle of their u.
TriangleMesh revolve(const std::function<Profile(double v)>& profile, Turn turn, int around, int up) {
  assert(around >= 3 && up >= 1);
  TriangleMesh mesh;
  const auto is_pole = [&](int row) { return profile(static_cast<double>(row) / up).radius == 0; };
  for (int row = 0; row <= up; ++row) {
    const double v = static_cast<double>(row) / up;
    const Profile at = profile(v);
    for (int column = 0; column <= around; ++column) {
      const double shift = is_pole(row) ? 0.5 : 0;
      const double angle = static_cast<int>(turn) * 2 * std::numbers::pi * (column % around) / around;
      const Vec3 out(elementary::cos(angle), 0, -elementary::sin(angle));
      mesh.positions.emplace_back(at.radius * out + at.y * Vec3::UnitY());
      mesh.normals.emplace_back(at.normal_radius * out + at.normal_y * Vec3::UnitY());
      mesh.uvs.emplace_back((column + shift) / around, v);
    }
  }
  for (int row = 0; row < up; ++row) {
    for (int column = 0; column < around; ++column) {
      const int low = row * (around + 1) + column;
      const int high = low + around + 1;
      if (!is_pole(row)) mesh.triangles.push_back({low, low + 1, is_pole(row + 1) ? high : high + 1});
      if (!is_pole(row + 1)) mesh.triangles.push_back({low, high + 1, high});
    }
  }
  return mesh;
}

// The circle at latitude `angle`; exactly on the axis at a pole.
Profile on_circle(double radius, double angle, double side) {
  const bool pole = std::abs(angle) > std::numbers::pi / 2 - 1e-9;
  const double c = pole ? 0 : elementary::cos(angle);
  const double s = pole ? std::copysign(1.0, angle) : elementary::sin(angle);
  return {radius * c, radius * s, side * c, side * s};
}

}  // namespace

TriangleMesh make_quad(const Placement& placement) {
  TriangleMesh mesh;
  for (const Vec2& uv : {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)}) {
    mesh.positions.push_back(
        placement.to_world({uv.x() * placement.size_u(), uv.y() * placement.size_v(), 0}));
    mesh.normals.push_back(placement.n());
    mesh.uvs.push_back(uv);
  }
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

TriangleMesh make_sphere(double radius, int around, int up) {
  const auto profile = [=](double v) { return on_circle(radius, std::numbers::pi * (v - 0.5), 1); };
  return revolve(profile, Turn::east, around, up);
}

TriangleMesh make_cylinder(double radius, double height, int around, int up) {
  const auto profile = [=](double v) { return Profile{radius, height * (v - 0.5), 1, 0}; };
  return revolve(profile, Turn::east, around, up);
}

TriangleMesh make_bowl(double radius, int around, int up) {
  const auto profile = [=](double v) { return on_circle(radius, std::numbers::pi / 2 * (v - 1), -1); };
  return revolve(profile, Turn::west, around, up);
}

}  // namespace intaglio::surface
