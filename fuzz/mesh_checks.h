// Laws of any mesh that was read: it can be placed and queried; an error is clear.
#pragma once

#include "fuzz/require.h"
#include "mesh/mesh_placement.h"

namespace intaglio::fuzz {

inline void query(const surface::TriangleMesh& mesh) {
  if (mesh.triangles.size() > 1000) return;
  const auto placement = surface::MeshPlacement::make(mesh, "fuzz");
  require(placement.has_value());  // it was checked already
  const surface::BasePoint on = placement->at(0, Vec3::Constant(1.0 / 3), 0);
  require(on.world().allFinite() && on.t.allFinite() && std::abs(on.n.norm() - 1) <= 1e-6);
  const Vec3 asked = on.point + 0.01 * on.n;
  if (const auto at = placement->closest(asked, 1))
    require((at->world() - asked).norm() <= 1e-6 * (1 + asked.norm()));
  placement->to_world(on.uv, 0.1);
  static_cast<void>(placement->check_depth(1));
}

inline void examine(const Result<surface::TriangleMesh>& mesh) {
  if (mesh) return query(*mesh);
  require_clear(mesh.error(), "fuzz");
}

}  // namespace intaglio::fuzz
