#include "intaglio/sound/fem/assemble.h"

#include "intaglio/sound/fem/assemble_elements.h"
#include "intaglio/sound/fem/element.h"

namespace intaglio::sound {

namespace {

using assembling::Neighbours;

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

ElasticSystem assembling::zero_system(const Neighbours& neighbours) {
  return {zero_stiffness(neighbours), zero_mass(neighbours)};
}

ElasticSystem assemble(const TetMesh& mesh, const Material& material) {
  return assemble_elements<10>(mesh.nodes.size(), mesh.tets, [&](std::size_t e) {
    const ElementNodes nodes = element_nodes(mesh, mesh.tets[e]);
    return ElementSystem<10>{element_stiffness(nodes, material), element_mass(nodes, material.density)};
  });
}

}  // namespace intaglio::sound
