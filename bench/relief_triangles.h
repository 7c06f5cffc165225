// The relief of a texture as a triangle mesh, for measuring what meshes cost.
#pragma once

#include "intaglio/triangle_mesh.h"
#include "surface/surface.h"

namespace intaglio::bench {

// The relief's texels as vertices, UVs as the texture's, without the repeat at its edge.
inline TriangleMesh relief_triangles(const surface::Surface& s) {
  TriangleMesh mesh;
  const int n = s.width();
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const Vec2 uv((i + 0.5) / n, (j + 0.5) / n);
      mesh.positions.push_back(s.placement().to_world(
          {uv.x() * s.placement().size_u(), uv.y() * s.placement().size_v(), s.texel_z(i, j)}));
      mesh.normals.push_back(Vec3::Zero());  // from the triangles
      mesh.uvs.push_back(uv);
    }
  }
  for (int j = 0; j + 1 < n; ++j) {
    for (int i = 0; i + 1 < n; ++i) {
      const int a = j * n + i;
      mesh.triangles.push_back({a, a + 1, a + n + 1});
      mesh.triangles.push_back({a, a + n + 1, a + n});
    }
  }
  return mesh;
}

}  // namespace intaglio::bench
