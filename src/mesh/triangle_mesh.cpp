#include "mesh/triangle_mesh.h"

#include <fmt/format.h>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <numbers>
#include <tuple>

#include "core/portable_math.h"
#include "mesh/triangle_search.h"

namespace intaglio::surface {

namespace {

constexpr double max_coordinate = 1e6;  // metres
constexpr double max_uv = 1e6;
constexpr double min_edge = 1e-9;           // metres; shorter triangles have no direction left in double
constexpr double min_relative_area = 1e-9;  // of the longest edge squared

Result<void> check_lists(const TriangleMesh& mesh, const std::string& name) {
  const std::size_t count = mesh.positions.size();
  if (mesh.triangles.empty()) return fail(name, "has no triangles", "a mesh needs at least one");
  if (mesh.uvs.empty())
    return fail(name, "has no UVs", "a texture needs them; unwrap the mesh and export its UVs");
  if (count > max_mesh_vertices)
    return fail(name, fmt::format("has {} vertices", count),
                fmt::format("at most {} are read", max_mesh_vertices));
  if (mesh.triangles.size() > max_mesh_triangles)
    return fail(name, fmt::format("has {} triangles", mesh.triangles.size()),
                fmt::format("at most {} are read", max_mesh_triangles));
  if (mesh.uvs.size() != count || mesh.normals.size() != count)
    return fail(
        name,
        fmt::format("has {} positions, {} normals and {} UVs", count, mesh.normals.size(), mesh.uvs.size()),
        "one of each for every vertex");
  return {};
}

Result<void> check_numbers(const TriangleMesh& mesh, const std::string& name) {
  // Written so that a NaN fails: every comparison with it is false.
  const auto within = [](const auto& vector, double limit) { return (vector.array().abs() <= limit).all(); };
  for (std::size_t k = 0; k < mesh.positions.size(); ++k) {
    if (!within(mesh.positions[k], max_coordinate))
      return fail(name,
                  fmt::format("vertex {}: its position is not finite or beyond {} m", k, max_coordinate));
    if (!within(mesh.uvs[k], max_uv))
      return fail(name, fmt::format("vertex {}: its UV is not finite or beyond {}", k, max_uv));
    if (!within(mesh.normals[k], 1e100))
      return fail(name, fmt::format("vertex {}: its normal is not finite", k));
  }
  const auto count = int(mesh.positions.size());
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    for (const int index : mesh.triangles[k]) {
      if (index < 0 || index >= count)
        return fail(name, fmt::format("triangle {} uses vertex {}", k, index),
                    fmt::format("there are {}", count));
    }
  }
  return {};
}

// Twice the area, along the facet's normal.
Vec3 area_vector(const TriangleMesh& mesh, const Triangle& triangle) {
  const Vec3& p = mesh.positions[std::size_t(triangle[0])];
  return (mesh.positions[std::size_t(triangle[1])] - p).cross(mesh.positions[std::size_t(triangle[2])] - p);
}

bool has_area(const TriangleMesh& mesh, const Triangle& triangle) {
  double longest2 = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 edge =
        mesh.positions[std::size_t(triangle[(k + 1) % 3])] - mesh.positions[std::size_t(triangle[k])];
    longest2 = std::max(longest2, edge.squaredNorm());
  }
  return longest2 > min_edge * min_edge && area_vector(mesh, triangle).norm() > min_relative_area * longest2;
}

void drop_degenerate(TriangleMesh& mesh) {
  const std::size_t before = mesh.triangles.size();
  std::erase_if(mesh.triangles, [&](const Triangle& triangle) { return !has_area(mesh, triangle); });
  const std::size_t dropped = before - mesh.triangles.size();
  if (dropped > 0)
    mesh.notes.push_back(fmt::format("{} of {} triangles have no area and were dropped", dropped, before));
}

bool is_missing(const Vec3& normal) {
  return normal.norm() < 1e-6;
}

// Unit normals everywhere; a missing one becomes the area-weighted mean of the facets around its position.
void complete_normals(TriangleMesh& mesh) {
  const auto missing = std::count_if(mesh.normals.begin(), mesh.normals.end(), is_missing);
  if (missing > 0) {
    // The two sides of a UV seam share their computed normal.
    const std::vector<int> place = group_equal(mesh.positions.size(), [&](std::size_t k) {
      const Vec3& p = mesh.positions[k];
      return std::tuple(p.x(), p.y(), p.z());
    });
    std::vector<Vec3> sum(mesh.positions.size(), Vec3::Zero());
    for (const Triangle& triangle : mesh.triangles) {
      const Vec3 area = area_vector(mesh, triangle);
      for (const int index : triangle) sum[std::size_t(place[std::size_t(index)])] += area;
    }
    for (std::size_t k = 0; k < mesh.normals.size(); ++k) {
      if (!is_missing(mesh.normals[k])) continue;
      const Vec3& normal = sum[std::size_t(place[k])];
      const double length = normal.norm();
      mesh.normals[k] = length > 0 ? Vec3(normal / length) : Vec3(Vec3::UnitY());
    }
    mesh.notes.push_back(
        fmt::format("{} of {} normals were missing and were computed", missing, mesh.normals.size()));
  }
  for (Vec3& normal : mesh.normals) normal.stableNormalize();
}

// Where all three normals say that the other side is outside, the winding is flipped to agree.
void flip_windings(TriangleMesh& mesh) {
  std::size_t flipped = 0;
  for (Triangle& triangle : mesh.triangles) {
    const Vec3 area = area_vector(mesh, triangle);
    const auto against = [&](int index) { return area.dot(mesh.normals[std::size_t(index)]) < 0; };
    if (!std::all_of(triangle.begin(), triangle.end(), against)) continue;
    std::swap(triangle[1], triangle[2]);
    ++flipped;
  }
  if (flipped > 0)
    mesh.notes.push_back(fmt::format("{} triangles were flipped to match their normals", flipped));
}

}  // namespace

Result<TriangleMesh> checked(TriangleMesh raw, const std::string& name) {
  if (auto sound = check_lists(raw, name); !sound) return tl::unexpected(sound.error());
  if (auto sound = check_numbers(raw, name); !sound) return tl::unexpected(sound.error());
  drop_degenerate(raw);
  if (raw.triangles.empty()) return fail(name, "has only triangles without area");
  complete_normals(raw);
  flip_windings(raw);
  return raw;
}

TriangleMesh moved(TriangleMesh mesh, const Pose& pose) {
  for (Vec3& position : mesh.positions) position = pose.to_world(position);
  for (Vec3& normal : mesh.normals) normal = pose.orientation * normal;
  return mesh;
}

namespace {

// Vertices of equal position, normal and UV have the same number.
std::vector<int> weld(const TriangleMesh& mesh) {
  return group_equal(mesh.positions.size(), [&](std::size_t k) {
    const Vec3& p = mesh.positions[k];
    const Vec3& n = mesh.normals[k];
    const Vec2& uv = mesh.uvs[k];
    return std::tuple(p.x(), p.y(), p.z(), n.x(), n.y(), n.z(), uv.x(), uv.y());
  });
}

Vec3 project_to_plane(const Vec3& n, const Vec3& direction) {
  const Vec3 flat = direction - n.dot(direction) * n;
  const double length = flat.norm();
  return length > 1e-9 * direction.norm() ? Vec3(flat / length) : Vec3(Vec3::Zero());
}

double corner_angle(const TriangleMesh& mesh, const Triangle& triangle, std::size_t corner, const Vec3& n) {
  const auto position = [&](std::size_t k) { return mesh.positions[std::size_t(triangle[k % 3])]; };
  const Vec3 a = project_to_plane(n, position(corner + 1) - position(corner));
  const Vec3 b = project_to_plane(n, position(corner + 2) - position(corner));
  return elementary::acos(std::clamp(a.dot(b), -1.0, 1.0));
}

}  // namespace

UvDerivatives uv_derivatives(const TriangleMesh& mesh, std::size_t triangle) {
  const Triangle& corners = mesh.triangles[triangle];
  const auto a = std::size_t(corners[0]);
  const auto b = std::size_t(corners[1]);
  const auto c = std::size_t(corners[2]);
  const Vec2 uv1 = mesh.uvs[b] - mesh.uvs[a];
  const Vec2 uv2 = mesh.uvs[c] - mesh.uvs[a];
  const double determinant = uv1.x() * uv2.y() - uv1.y() * uv2.x();
  const double scale = std::max(uv1.squaredNorm(), uv2.squaredNorm());
  if (!(std::abs(determinant) > 1e-12 * scale) || scale < 1e-24) return {Vec3::Zero(), Vec3::Zero(), 1};
  const Vec3 e1 = mesh.positions[b] - mesh.positions[a];
  const Vec3 e2 = mesh.positions[c] - mesh.positions[a];
  return {(uv2.y() * e1 - uv1.y() * e2) / determinant, (uv1.x() * e2 - uv2.x() * e1) / determinant,
          determinant > 0 ? 1.0 : -1.0};
}

TangentFrame frame_along(const Vec3& n, const Vec3& tangent, double handedness) {
  Vec3 t = project_to_plane(n, tangent);
  if (t.isZero()) t = n.unitOrthogonal();
  // Re-orthogonalise: the residual along n is amplified when the tangent was nearly parallel to it.
  t = (t - n.dot(t) * n).normalized();
  return {t, handedness * n.cross(t), n};
}

CornerTangents corner_tangents(const TriangleMesh& mesh) {
  const std::vector<int> vertex = weld(mesh);
  std::array<std::vector<Vec3>, 2> sum;  // of the mirrored triangles, and of the others
  sum.fill(std::vector<Vec3>(mesh.positions.size(), Vec3::Zero()));
  CornerTangents tangents;
  tangents.t.resize(mesh.triangles.size());
  tangents.handedness.resize(mesh.triangles.size());
  const auto each_corner = [&](auto&& visit) {
    for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const auto index = std::size_t(mesh.triangles[k][corner]);
        visit(k, corner, mesh.normals[index],
              sum[tangents.handedness[k] > 0 ? 1 : 0][std::size_t(vertex[index])]);
      }
    }
  };
  std::vector<Vec3> along_u(mesh.triangles.size());
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const UvDerivatives derivatives = uv_derivatives(mesh, k);
    along_u[k] = derivatives.by_u;
    tangents.handedness[k] = std::int8_t(derivatives.handedness);
  }
  each_corner([&](std::size_t k, std::size_t corner, const Vec3& n, Vec3& total) {
    total += corner_angle(mesh, mesh.triangles[k], corner, n) * project_to_plane(n, along_u[k]);
  });
  each_corner([&](std::size_t k, std::size_t corner, const Vec3& n, const Vec3& total) {
    tangents.t[k][corner] = frame_along(n, total, tangents.handedness[k]).t;
  });
  return tangents;
}

namespace {

// A point of the curve that is revolved about the Y axis, with its normal in the same plane.
struct Profile {
  double radius, y;
  double normal_radius, normal_y;
};

// The way in which u goes around, seen from +Y: east is counter-clockwise.
enum class Winding { east = 1, west = -1 };

// A row has one vertex more than quads: the seam is stored for u = 0 and for u = 1. At a pole each triangle
// has one corner, at the middle of its u.
TriangleMesh revolve(const std::function<Profile(double v)>& profile, Winding winding, int around, int up) {
  assert(around >= 3 && up >= 1);
  TriangleMesh mesh;
  const auto is_pole = [&](int row) { return profile(double(row) / up).radius == 0; };
  for (int row = 0; row <= up; ++row) {
    const double v = double(row) / up;
    const Profile at = profile(v);
    for (int column = 0; column <= around; ++column) {
      const double shift = is_pole(row) ? 0.5 : 0;
      const double angle = int(winding) * 2 * std::numbers::pi * (column % around) / around;
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
Profile meridian(double radius, double angle, double normal_sign) {
  const bool pole = std::abs(angle) > std::numbers::pi / 2 - 1e-9;
  const double c = pole ? 0 : elementary::cos(angle);
  const double s = pole ? std::copysign(1.0, angle) : elementary::sin(angle);
  return {radius * c, radius * s, normal_sign * c, normal_sign * s};
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
  const auto profile = [=](double v) { return meridian(radius, std::numbers::pi * (v - 0.5), 1); };
  return revolve(profile, Winding::east, around, up);
}

TriangleMesh make_cylinder(double radius, double height, int around, int up) {
  const auto profile = [=](double v) { return Profile{radius, height * (v - 0.5), 1, 0}; };
  return revolve(profile, Winding::east, around, up);
}

TriangleMesh make_bowl(double radius, int around, int up) {
  const auto profile = [=](double v) { return meridian(radius, std::numbers::pi / 2 * (v - 1), -1); };
  return revolve(profile, Winding::west, around, up);
}

}  // namespace intaglio::surface
