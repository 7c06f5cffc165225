// The stiffness and mass matrices of a whole body: K U = M U Lambda is what modal analysis solves.
#pragma once

#include <Eigen/SparseCore>

#include "intaglio/core/material.h"
#include "intaglio/sound/fem/tet_mesh.h"

namespace intaglio::sound {

using SparseMatrix = Eigen::SparseMatrix<double>;

struct ElasticSystem {
  SparseMatrix stiffness;  // K, N/m
  SparseMatrix mass;       // M, kg
};

// Both triangles of both matrices, compressed, degrees of freedom 3 * node + axis. About 25 microseconds a
// tetrahedron.
ElasticSystem assemble(const TetMesh& mesh, const Material& material);

}  // namespace intaglio::sound
