#include "intaglio/surface/mesh/triangle_mesh.h"

#include <algorithm>
#include <numeric>

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
  const auto count = static_cast<int>(mesh.positions.size());
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    for (const int index : mesh.triangles[k]) {
      if (index < 0 || index >= count)
        return fail(name, fmt::format("triangle {} names vertex {}", k, index),
                    fmt::format("there are {}", count));
    }
  }
  return {};
}

// Twice the area, along the facet's normal.
Vec3 area_vector(const TriangleMesh& mesh, const Triangle& triangle) {
  const Vec3& p = mesh.positions[static_cast<std::size_t>(triangle[0])];
  return (mesh.positions[static_cast<std::size_t>(triangle[1])] - p)
      .cross(mesh.positions[static_cast<std::size_t>(triangle[2])] - p);
}

bool has_area(const TriangleMesh& mesh, const Triangle& triangle) {
  double longest2 = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 edge = mesh.positions[static_cast<std::size_t>(triangle[(k + 1) % 3])] -
                      mesh.positions[static_cast<std::size_t>(triangle[k])];
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

// For each vertex the lowest vertex at the same place: the two sides of a UV seam share their computed
// normal.
std::vector<std::size_t> same_place(const std::vector<Vec3>& positions) {
  std::vector<std::size_t> order(positions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto key = [&](std::size_t k) {
    return std::make_tuple(positions[k].x(), positions[k].y(), positions[k].z());
  };
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  std::vector<std::size_t> first(positions.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool same = k > 0 && key(order[k]) == key(order[k - 1]);
    first[order[k]] = same ? first[order[k - 1]] : order[k];
  }
  return first;
}

bool unknown(const Vec3& normal) {
  return normal.norm() < 1e-6;
}

// Unit normals everywhere; where one is not known, the area-weighted mean of the facets around its place.
void complete_normals(TriangleMesh& mesh) {
  const auto missing = std::count_if(mesh.normals.begin(), mesh.normals.end(), unknown);
  if (missing > 0) {
    const std::vector<std::size_t> place = same_place(mesh.positions);
    std::vector<Vec3> sum(mesh.positions.size(), Vec3::Zero());
    for (const Triangle& triangle : mesh.triangles) {
      const Vec3 area = area_vector(mesh, triangle);
      for (const int index : triangle) sum[place[static_cast<std::size_t>(index)]] += area;
    }
    for (std::size_t k = 0; k < mesh.normals.size(); ++k) {
      if (!unknown(mesh.normals[k])) continue;
      const double length = sum[place[k]].norm();
      mesh.normals[k] = length > 0 ? Vec3(sum[place[k]] / length) : Vec3(Vec3::UnitY());
    }
    mesh.notes.push_back(
        fmt::format("{} of {} normals were missing and were computed", missing, mesh.normals.size()));
  }
  for (Vec3& normal : mesh.normals) normal.stableNormalize();
}

// Where all three normals say that the other side is outside, they are believed and the winding is turned.
void turn_windings(TriangleMesh& mesh) {
  std::size_t turned = 0;
  for (Triangle& triangle : mesh.triangles) {
    const Vec3 area = area_vector(mesh, triangle);
    const auto against = [&](int index) {
      return area.dot(mesh.normals[static_cast<std::size_t>(index)]) < 0;
    };
    if (!std::all_of(triangle.begin(), triangle.end(), against)) continue;
    std::swap(triangle[1], triangle[2]);
    ++turned;
  }
  if (turned > 0)
    mesh.notes.push_back(fmt::format("{} triangles wound against their normals and were turned", turned));
}

}  // namespace

Result<TriangleMesh> checked(TriangleMesh raw, const std::string& name) {
  if (auto sound = check_lists(raw, name); !sound) return tl::unexpected(sound.error());
  if (auto sound = check_numbers(raw, name); !sound) return tl::unexpected(sound.error());
  drop_degenerate(raw);
  if (raw.triangles.empty()) return fail(name, "has only triangles without area");
  complete_normals(raw);
  turn_windings(raw);
  return raw;
}

TriangleMesh moved(TriangleMesh mesh, const Pose& pose) {
  for (Vec3& position : mesh.positions) position = pose.to_world(position);
  for (Vec3& normal : mesh.normals) normal = pose.orientation * normal;
  return mesh;
}

}  // namespace intaglio::surface
