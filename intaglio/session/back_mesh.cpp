#include "intaglio/session/back_mesh.h"

#include <array>
#include <map>
#include <tuple>

namespace intaglio::session {

namespace {

std::array<float, 3> floats(const Vec3& v) {
  return {float(v.x()), float(v.y()), float(v.z())};
}

// Edges that one triangle has, by their corners: those of a seam are the same in two vertices each.
std::vector<std::array<int, 2>> rim_of(const surface::TriangleMesh& base) {
  using Place = std::tuple<double, double, double>;
  std::map<Place, int> welded;
  const auto name = [&](int k) {
    const Vec3& p = base.positions[static_cast<std::size_t>(k)];
    return welded.try_emplace({p.x(), p.y(), p.z()}, k).first->second;
  };
  std::map<std::array<int, 2>, std::array<int, 2>> single;  // from, to; as they are in their triangle
  for (const surface::Triangle& t : base.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      if (single.erase({name(b), name(a)}) == 0) single[{name(a), name(b)}] = {a, b};
    }
  }
  std::vector<std::array<int, 2>> rim;
  for (const auto& [names, edge] : single)
    if (names[0] != names[1]) rim.push_back(edge);
  return rim;
}

}  // namespace

render::Mesh back_mesh(const surface::TriangleMesh& base, double relief, double thickness) {
  const auto rim = rim_of(base);
  render::Mesh mesh;
  if (rim.empty()) return mesh;
  const auto at = [&](int k) { return static_cast<std::size_t>(k); };
  const auto below = [&](int k, double by) { return Vec3(base.positions[at(k)] - by * base.normals[at(k)]); };
  for (std::size_t k = 0; k < base.positions.size(); ++k)
    mesh.vertices.push_back({floats(below(static_cast<int>(k), thickness)), floats(-base.normals[k])});
  for (const surface::Triangle& t : base.triangles)
    for (const int k : {t[0], t[2], t[1]}) mesh.indices.push_back(static_cast<std::uint32_t>(k));
  for (const auto& [a, b] : rim) {
    const std::array<Vec3, 4> corners = {below(a, relief), below(a, thickness), below(b, thickness),
                                         below(b, relief)};
    const Vec3 normal = (corners[1] - corners[0]).cross(corners[3] - corners[0]).normalized();
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3& corner : corners) mesh.vertices.push_back({floats(corner), floats(normal)});
    for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(first + k);
  }
  return mesh;
}

}  // namespace intaglio::session
