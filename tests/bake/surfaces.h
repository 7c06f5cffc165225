// Closed triangle meshes for tests of filling, as readers give them.
#pragma once

#include <map>
#include <numbers>

#include "mesh/triangle_mesh.h"
#include "sound/bake/fem/fill_surface.h"

namespace intaglio::sound::test {

// Any mesh, prepared and filled.
inline Result<FilledSurface> fill_surface(const surface::TriangleMesh& mesh, const FillOptions& options,
                                          const std::string& name) {
  const auto body = body_surface(mesh, name);
  if (!body) return tl::unexpected(body.error());
  return sound::fill_surface(*body, options, name);
}

inline surface::TriangleMesh mesh_of(std::vector<Vec3> points, std::vector<surface::Triangle> triangles) {
  surface::TriangleMesh mesh;
  mesh.normals.assign(points.size(), Vec3::Zero());
  mesh.uvs.assign(points.size(), Vec2::Zero());
  mesh.positions = std::move(points);
  mesh.triangles = std::move(triangles);
  return mesh;
}

inline surface::TriangleMesh icosphere(double radius, int level) {
  constexpr double g = std::numbers::phi;
  std::vector<Vec3> points{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                           {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<surface::Triangle> faces{{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                       {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                       {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                       {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (; level > 0; --level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), int(points.size()));
      if (is_new) points.push_back(0.5 * (points[std::size_t(a)] + points[std::size_t(b)]));
      return at->second;
    };
    std::vector<surface::Triangle> finer;
    for (const auto& [a, b, c] : faces) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    faces = std::move(finer);
    for (Vec3& p : points) p.normalize();
  }
  for (Vec3& p : points) p = radius * p.normalized();
  return mesh_of(std::move(points), std::move(faces));
}

inline surface::TriangleMesh cuboid(const Vec3& size) {
  std::vector<Vec3> points;
  for (int k = 0; k < 8; ++k)
    points.emplace_back(0.5 * size.cwiseProduct(Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1)));
  return mesh_of(std::move(points), {{0, 2, 1},
                                     {1, 2, 3},
                                     {4, 5, 6},
                                     {5, 7, 6},
                                     {0, 1, 4},
                                     {1, 5, 4},
                                     {2, 6, 3},
                                     {3, 6, 7},
                                     {0, 4, 2},
                                     {2, 4, 6},
                                     {1, 3, 5},
                                     {3, 7, 5}});
}

inline surface::TriangleMesh turned(surface::TriangleMesh mesh, const Quat& rotation) {
  for (Vec3& p : mesh.positions) p = rotation * p;
  return mesh;
}

// Both in one mesh, the second one moved.
inline surface::TriangleMesh together(surface::TriangleMesh a, const surface::TriangleMesh& b,
                                      const Vec3& by) {
  const auto first = int(a.positions.size());
  for (const Vec3& p : b.positions) a.positions.emplace_back(p + by);
  for (const auto& [i, j, k] : b.triangles) a.triangles.push_back({first + i, first + j, first + k});
  return mesh_of(std::move(a.positions), std::move(a.triangles));
}

}  // namespace intaglio::sound::test
