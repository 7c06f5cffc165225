#include "intaglio/sound/fem/fit_surface.h"

#include <cmath>
#include <map>

#include "intaglio/sound/fem/element.h"

namespace intaglio::sound {

namespace {

constexpr double max_rescaling = 0.05;
constexpr double least_jacobian = 0.1;  // of the mean over the element

bool is_positive(const TetMesh& mesh, const Tet10& tet) {
  const ElementNodes nodes = element_nodes(mesh, tet);
  const double least = least_jacobian * 6 * element_volume(nodes);
  if (!(least > 0)) return false;
  for (const QuadraturePoint& q : tet_quadrature()) {
    if (!(jacobian(nodes, q.barycentric) > least)) return false;
  }
  for (std::size_t corner = 0; corner < 4; ++corner) {
    std::array<double, 4> at{};
    at[corner] = 1;
    if (!(jacobian(nodes, at) > least)) return false;
  }
  return true;
}

// Moves the mid-edge nodes of the boundary onto the surface; those of elements that suffer go back.
void curve(TetMesh& mesh, const SurfaceQuery& surface) {
  std::map<int, Vec3> straight;
  for (const Triangle6& f : mesh.boundary) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int middle = f[3 + k];
      Vec3& node = mesh.nodes[std::size_t(middle)];
      if (!straight.try_emplace(middle, node).second) continue;
      const double length = (mesh.nodes[std::size_t(f[k])] - mesh.nodes[std::size_t(f[(k + 1) % 3])]).norm();
      if (const auto nearest = surface.nearest(node, 0.25 * length)) node = *nearest;
    }
  }
  for (bool suffered = true; suffered;) {
    suffered = false;
    for (const Tet10& tet : mesh.tets) {
      if (is_positive(mesh, tet)) continue;
      for (std::size_t k = 4; k < 10; ++k) {
        const auto found = straight.find(tet[k]);
        if (found == straight.end()) continue;
        mesh.nodes[std::size_t(tet[k])] = found->second;
        straight.erase(found);
        suffered = true;
      }
    }
  }
}

void restore_volume(TetMesh& mesh, const BodySurface& body, std::vector<std::string>& notes) {
  const double ratio = body.volume / volume(mesh);
  if (std::abs(ratio - 1) > max_rescaling) {
    notes.push_back(
        fmt::format("the volume within the windings is {:.3g} times what was filled: it overlaps itself "
                    "or has parts finer than an element",
                    ratio));
    return;
  }
  const Vec3 middle = 0.5 * (body.low + body.high);
  const double scale = std::cbrt(ratio);
  for (Vec3& node : mesh.nodes) node = middle + scale * (node - middle);
}

}  // namespace

void fit_surface(TetMesh& mesh, const BodySurface& body, const SurfaceQuery& surface,
                 std::vector<std::string>& notes) {
  curve(mesh, surface);
  if (body.is_closed()) restore_volume(mesh, body, notes);
}

}  // namespace intaglio::sound
