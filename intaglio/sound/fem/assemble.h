// The stiffness and mass matrices of a whole body: K U = M U Lambda is what modal analysis solves.
#pragma once

#include <Eigen/SparseCore>

#include "intaglio/core/material.h"
#include "intaglio/sound/fem/tet_mesh.h"

namespace intaglio::sound {

using SparseMatrix = Eigen::SparseMatrix<double>;

// Degrees of freedom are 3 * node + axis. Only what is needed once is held: at 400,000 nodes K alone is
// 0.6 GB.
struct ElasticSystem {
  SparseMatrix stiffness;  // K, N/m: its lower triangle, compressed
  SparseMatrix mass;       // M, kg: node by node, both triangles; the same for every axis

  Eigen::Index dofs() const { return stiffness.cols(); }
  // M x and K x for a block of vectors, one a column. M costs about 60 ns a node and column.
  Eigen::MatrixXd mass_times(const Eigen::MatrixXd& x) const;
  Eigen::MatrixXd stiffness_times(const Eigen::MatrixXd& x) const;
};

// About 25 microseconds a tetrahedron.
ElasticSystem assemble(const TetMesh& mesh, const Material& material);

}  // namespace intaglio::sound
