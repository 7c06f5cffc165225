// Meshes and random points on them, for the tests of src/mesh.
#pragma once

#include <cmath>

#include "core/portable_math.h"
#include "mesh/mesh_placement.h"
#include "mesh/triangle_mesh.h"

namespace intaglio::tests {

// An n x n grid over 1 m, with hills of 8 cm: curved both ways, and with normals that are only those of its
// vertices.
inline surface::TriangleMesh wavy(int n) {
  surface::TriangleMesh mesh;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const double x = double(i) / n, z = double(j) / n;
      mesh.positions.emplace_back(x, 0.04 * (std::sin(7 * x) + std::cos(5 * z + 2 * x)), -z);
      mesh.normals.emplace_back(Vec3::Zero());
      mesh.uvs.emplace_back(x, z);
    }
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + n + 1;
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
  }
  return mesh;
}

inline Quat any_rotation(Random& random) {
  return Quat(random.normal(), random.normal(), random.normal(), random.normal()).normalized();
}

inline Vec3 any_vector(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

// Weights of a triangle's corners, uniform over it.
inline Vec3 any_weights(Random& random) {
  const double a = std::sqrt(random.uniform()), b = random.uniform();
  return {1 - a, a * (1 - b), a * b};
}

inline int any_triangle(Random& random, const surface::MeshPlacement& placement) {
  return int(random.uniform() * double(placement.mesh().triangles.size()));
}

}  // namespace intaglio::tests
