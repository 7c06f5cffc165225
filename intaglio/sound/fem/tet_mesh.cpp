#include "intaglio/sound/fem/tet_mesh.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <unordered_map>

#include "intaglio/sound/fem/element.h"

namespace intaglio::sound {

namespace {

// Makes each mid-edge node once, however many tetrahedra share the edge.
class MidEdgeNodes {
 public:
  explicit MidEdgeNodes(std::vector<Vec3>& nodes) : nodes_(nodes) {}

  int between(int a, int b) {
    const std::uint64_t key =
        static_cast<std::uint64_t>(std::min(a, b)) << 32 | static_cast<std::uint64_t>(std::max(a, b));
    const auto [found, is_new] = made_.try_emplace(key, static_cast<int>(nodes_.size()));
    if (is_new) {
      const Vec3 middle = 0.5 * (nodes_[std::size_t(a)] + nodes_[std::size_t(b)]);
      nodes_.push_back(middle);
    }
    return found->second;
  }

 private:
  std::vector<Vec3>& nodes_;
  std::unordered_map<std::uint64_t, int> made_;
};

bool is_positive(const std::vector<Vec3>& nodes, const std::array<int, 4>& tet) {
  const Vec3& origin = nodes[std::size_t(tet[0])];
  const auto edge = [&](std::size_t corner) -> Vec3 { return nodes[std::size_t(tet[corner])] - origin; };
  return edge(1).cross(edge(2)).dot(edge(3)) > 0;
}

std::vector<Triangle6> boundary_of(const std::vector<Tet10>& tets, MidEdgeNodes& mid_edge) {
  std::map<std::array<int, 3>, std::pair<int, std::array<int, 3>>>
      faces;  // sorted corners -> uses, outward corners
  for (const Tet10& tet : tets) {
    for (const auto& face : tet_faces) {
      const std::array<int, 3> outward{tet[std::size_t(face[0])], tet[std::size_t(face[1])],
                                       tet[std::size_t(face[2])]};
      auto key = outward;
      std::sort(key.begin(), key.end());
      auto& [uses, corners] = faces[key];
      ++uses;
      corners = outward;
    }
  }
  std::vector<Triangle6> boundary;
  for (const auto& [key, entry] : faces) {
    const auto& [uses, c] = entry;
    if (uses == 1) {
      boundary.push_back({c[0], c[1], c[2], mid_edge.between(c[0], c[1]), mid_edge.between(c[1], c[2]),
                          mid_edge.between(c[2], c[0])});
    }
  }
  return boundary;
}

}  // namespace

TetMesh quadratic_mesh(std::vector<Vec3> corners, std::vector<std::array<int, 4>> tets) {
  TetMesh mesh;
  mesh.nodes = std::move(corners);
  MidEdgeNodes mid_edge(mesh.nodes);
  for (auto& tet : tets) {
    if (!is_positive(mesh.nodes, tet)) std::swap(tet[2], tet[3]);
    Tet10 nodes{tet[0], tet[1], tet[2], tet[3]};
    for (std::size_t e = 0; e < tet_edges.size(); ++e) {
      nodes[4 + e] = mid_edge.between(tet[std::size_t(tet_edges[e][0])], tet[std::size_t(tet_edges[e][1])]);
    }
    mesh.tets.push_back(nodes);
  }
  mesh.boundary = boundary_of(mesh.tets, mid_edge);
  return mesh;
}

double volume(const TetMesh& mesh) {
  double sum = 0;
  for (const Tet10& tet : mesh.tets) sum += element_volume(element_nodes(mesh, tet));
  return sum;
}

}  // namespace intaglio::sound
