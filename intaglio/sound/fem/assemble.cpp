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

// An all-zero matrix of the nodes.
SparseMatrix zero_mass(const Neighbours& neighbours) {
  const auto nodes = static_cast<Eigen::Index>(neighbours.size());
  Eigen::Index entries = 0;
  for (const auto& list : neighbours) entries += static_cast<Eigen::Index>(list.size());
  SparseMatrix matrix(nodes, nodes);
  matrix.resizeNonZeros(entries);
  int next = 0;
  for (Eigen::Index a = 0; a < nodes; ++a) {
    matrix.outerIndexPtr()[a] = next;
    for (const int b : neighbours[std::size_t(a)]) matrix.innerIndexPtr()[next++] = b;
  }
  matrix.outerIndexPtr()[nodes] = next;
  std::fill_n(matrix.valuePtr(), entries, 0.0);
  return matrix;
}

// An all-zero lower triangle of the degrees of freedom.
SparseMatrix zero_stiffness(const Neighbours& neighbours) {
  const auto dofs = 3 * static_cast<Eigen::Index>(neighbours.size());
  const auto first_below = [&](int node) {
    const auto& list = neighbours[std::size_t(node)];
    return std::lower_bound(list.begin(), list.end(), node);
  };
  Eigen::Index entries = 0;
  for (int a = 0; a < dofs / 3; ++a) entries += 9 * (neighbours[std::size_t(a)].end() - first_below(a)) - 3;
  SparseMatrix matrix(dofs, dofs);
  matrix.resizeNonZeros(entries);
  int next = 0;
  for (int column = 0; column < dofs; ++column) {
    matrix.outerIndexPtr()[column] = next;
    const int node = column / 3;
    for (auto b = first_below(node); b != neighbours[std::size_t(node)].end(); ++b) {
      for (int row = std::max(3 * *b, column); row < 3 * *b + 3; ++row) matrix.innerIndexPtr()[next++] = row;
    }
  }
  matrix.outerIndexPtr()[dofs] = next;
  std::fill_n(matrix.valuePtr(), entries, 0.0);
  return matrix;
}

}  // namespace

namespace {

// out = M in, where all that belongs to a node, `Width` numbers, lies together.
template <int Width>
void multiply_nodes(const SparseMatrix& mass, Eigen::Index width, const double* in, double* out) {
  using Numbers = Eigen::Matrix<double, Width, 1>;
  for (int a = 0; a < mass.cols(); ++a) {
    Numbers sum = Numbers::Zero(width);
    for (SparseMatrix::InnerIterator entry(mass, a); entry; ++entry)
      sum += entry.value() * Eigen::Map<const Numbers>(in + entry.row() * width, width);
    Eigen::Map<Numbers>(out + a * width, width) = sum;
  }
}

}  // namespace

Eigen::MatrixXd ElasticSystem::mass_times(const Eigen::MatrixXd& x) const {
  // Transposed, the three axes of a node in all columns lie together: one scalar of M meets them all.
  const Eigen::MatrixXd in = x.transpose();
  Eigen::MatrixXd out(in.rows(), in.cols());
  if (x.cols() == 8) {
    multiply_nodes<24>(mass, 24, in.data(), out.data());
  } else {
    multiply_nodes<Eigen::Dynamic>(mass, 3 * x.cols(), in.data(), out.data());
  }
  return out.transpose();
}

Eigen::MatrixXd ElasticSystem::stiffness_times(const Eigen::MatrixXd& x) const {
  return stiffness.selfadjointView<Eigen::Lower>() * x;
}

ElasticSystem assemble(const TetMesh& mesh, const Material& material) {
  const Neighbours neighbours = node_neighbours(mesh);
  ElasticSystem system{zero_stiffness(neighbours), zero_mass(neighbours)};
  double* const stiffness = system.stiffness.valuePtr();
  double* const mass = system.mass.valuePtr();
  for (const Tet10& tet : mesh.tets) {
    const ElementNodes nodes = element_nodes(mesh, tet);
    const ElementMatrix k = element_stiffness(nodes, material);
    const ElementMass m = element_mass(nodes, material.density);
    for (int a = 0; a < 10; ++a) {
      const int node = tet[std::size_t(a)];
      const auto& list = neighbours[std::size_t(node)];
      const auto place_of = [&](int other) {
        return std::lower_bound(list.begin(), list.end(), other) - list.begin();
      };
      const auto diagonal = place_of(node);
      for (int b = 0; b < 10; ++b) {
        const int other = tet[std::size_t(b)];
        const auto place = place_of(other);
        mass[system.mass.outerIndexPtr()[node] + place] += m(b, a);
        if (other < node) continue;
        for (int axis = 0; axis < 3; ++axis) {
          // A column begins at its own diagonal: `axis` rows of the first block are above it.
          double* const rows =
              stiffness + system.stiffness.outerIndexPtr()[3 * node + axis] + 3 * (place - diagonal) - axis;
          for (int row = other == node ? axis : 0; row < 3; ++row) rows[row] += k(3 * b + row, 3 * a + axis);
        }
      }
    }
  }
  return system;
}

}  // namespace intaglio::sound
