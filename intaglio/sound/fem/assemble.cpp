#include "intaglio/sound/fem/assemble.h"

#include <algorithm>

#include "intaglio/sound/fem/element.h"

namespace intaglio::sound {

namespace {

using Neighbours = std::vector<std::vector<int>>;

// For each node the nodes that share a tetrahedron with it, itself included, ascending.
Neighbours node_neighbours(const TetMesh& mesh) {
  Neighbours neighbours(mesh.nodes.size());
  for (const Tet10& tet : mesh.tets) {
    for (const int a : tet)
      neighbours[std::size_t(a)].insert(neighbours[std::size_t(a)].end(), tet.begin(), tet.end());
  }
  for (auto& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return neighbours;
}

// An all-zero matrix in which node a's three columns hold, for each neighbour, rows 3b .. 3b+2 (`full`) or
// only the row of the same axis.
SparseMatrix zeros(const Neighbours& neighbours, bool full) {
  const auto dofs = 3 * static_cast<Eigen::Index>(neighbours.size());
  Eigen::Index entries = 0;
  for (const auto& list : neighbours) entries += static_cast<Eigen::Index>(list.size()) * (full ? 9 : 3);
  SparseMatrix matrix(dofs, dofs);
  matrix.resizeNonZeros(entries);
  int next = 0;
  for (int column = 0; column < dofs; ++column) {
    matrix.outerIndexPtr()[column] = next;
    for (const int b : neighbours[std::size_t(column / 3)]) {
      for (int axis = 0; axis < 3; ++axis) {
        if (full || axis == column % 3) matrix.innerIndexPtr()[next++] = 3 * b + axis;
      }
    }
  }
  matrix.outerIndexPtr()[dofs] = next;
  std::fill_n(matrix.valuePtr(), entries, 0.0);
  return matrix;
}

}  // namespace

ElasticSystem assemble(const TetMesh& mesh, const Material& material) {
  const Neighbours neighbours = node_neighbours(mesh);
  ElasticSystem system{zeros(neighbours, true), zeros(neighbours, false)};
  double* const stiffness = system.stiffness.valuePtr();
  double* const mass = system.mass.valuePtr();
  for (const Tet10& tet : mesh.tets) {
    const ElementNodes nodes = element_nodes(mesh, tet);
    const ElementMatrix k = element_stiffness(nodes, material);
    const ElementMass m = element_mass(nodes, material.density);
    for (int a = 0; a < 10; ++a) {
      const int column = 3 * tet[std::size_t(a)];
      const auto& list = neighbours[std::size_t(tet[std::size_t(a)])];
      for (int b = 0; b < 10; ++b) {
        const auto place = std::lower_bound(list.begin(), list.end(), tet[std::size_t(b)]) - list.begin();
        for (int axis = 0; axis < 3; ++axis) {
          mass[system.mass.outerIndexPtr()[column + axis] + place] += m(b, a);
          double* const rows = stiffness + system.stiffness.outerIndexPtr()[column + axis] + 3 * place;
          for (int row = 0; row < 3; ++row) rows[row] += k(3 * b + row, 3 * a + axis);
        }
      }
    }
  }
  return system;
}

}  // namespace intaglio::sound
