#include "sound/bake/fem/elastic_system.h"

#include <Eigen/LU>

namespace intaglio::sound {

namespace {

using detail::Neighbours;

// An all-zero matrix of the nodes.
SparseMatrix zero_mass(const Neighbours& neighbours) {
  const auto nodes = Eigen::Index(neighbours.size());
  Eigen::Index entries = 0;
  for (const auto& list : neighbours) entries += Eigen::Index(list.size());
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
  const auto dofs = 3 * Eigen::Index(neighbours.size());
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

// out = M in, with the `Width` numbers of each node contiguous.
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

// Precomputed shape functions at a quadrature point: the same for all elements.
struct ReferencePoint {
  double weight;
  ShapeValues value;
  ShapeGradients gradient;
};

const std::array<ReferencePoint, 14>& reference_points() {
  static const auto points = [] {
    std::array<ReferencePoint, 14> all;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const QuadraturePoint& q = tet_quadrature()[i];
      all[i] = {q.weight / 6, shape_values(q.barycentric), reference_gradients(q.barycentric)};
    }
    return all;
  }();
  return points;
}

Mat3 jacobian_matrix(const ElementNodes& nodes, const ShapeGradients& gradient) {
  return nodes * gradient.transpose();
}

}  // namespace

Eigen::MatrixXd ElasticSystem::mass_times(const Eigen::MatrixXd& x) const {
  // Transposed, the three axes of a node are contiguous over all columns: one scalar of M multiplies them
  // all.
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

ElasticSystem detail::zero_system(const Neighbours& neighbours) {
  return {zero_stiffness(neighbours), zero_mass(neighbours)};
}

ElasticSystem assemble(const TetMesh& mesh, const Material& material, const std::atomic<bool>* stop) {
  return assemble_elements<10>(
      mesh.nodes.size(), mesh.tets,
      [&](std::size_t e) {
        const ElementNodes nodes = element_nodes(mesh, mesh.tets[e]);
        return ElementSystem<10>{element_stiffness(nodes, material), element_mass(nodes, material.density)};
      },
      stop);
}

const std::array<QuadraturePoint, 14>& tet_quadrature() {
  static const auto points = [] {
    std::array<QuadraturePoint, 14> all;
    std::size_t next = 0;
    const auto add_corner_orbit = [&](double a, double weight) {
      for (std::size_t corner = 0; corner < 4; ++corner) {
        all[next] = {{a, a, a, a}, weight};
        all[next++].barycentric[corner] = 1 - 3 * a;
      }
    };
    add_corner_orbit(0.31088591926330060980, 0.11268792571801585080);
    add_corner_orbit(0.092735250310891226402, 0.073493043116361949544);
    constexpr double a = 0.045503704125649649492;
    for (const auto& [i, j] : tet_edges) {
      all[next] = {{a, a, a, a}, 0.042546020777081466438};
      all[next].barycentric[std::size_t(i)] = 0.5 - a;
      all[next++].barycentric[std::size_t(j)] = 0.5 - a;
    }
    return all;
  }();
  return points;
}

ElementNodes element_nodes(const TetMesh& mesh, const Tet10& tet) {
  ElementNodes nodes;
  for (int a = 0; a < 10; ++a) nodes.col(a) = mesh.nodes[std::size_t(tet[std::size_t(a)])];
  return nodes;
}

ShapeValues shape_values(const std::array<double, 4>& b) {
  ShapeValues n;
  for (int corner = 0; corner < 4; ++corner)
    n[corner] = b[std::size_t(corner)] * (2 * b[std::size_t(corner)] - 1);
  for (int e = 0; e < 6; ++e) {
    const auto& [i, j] = tet_edges[std::size_t(e)];
    n[4 + e] = 4 * b[std::size_t(i)] * b[std::size_t(j)];
  }
  return n;
}

ShapeGradients reference_gradients(const std::array<double, 4>& b) {
  // Barycentric coordinate 0 is 1 - b1 - b2 - b3.
  const std::array<Vec3, 4> db{Vec3(-1, -1, -1), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  ShapeGradients g;
  for (int corner = 0; corner < 4; ++corner)
    g.col(corner) = (4 * b[std::size_t(corner)] - 1) * db[std::size_t(corner)];
  for (int e = 0; e < 6; ++e) {
    const auto i = std::size_t(tet_edges[std::size_t(e)][0]), j = std::size_t(tet_edges[std::size_t(e)][1]);
    g.col(4 + e) = 4 * (b[i] * db[j] + b[j] * db[i]);
  }
  return g;
}

double jacobian(const ElementNodes& nodes, const std::array<double, 4>& barycentric) {
  return jacobian_matrix(nodes, reference_gradients(barycentric)).determinant();
}

double element_volume(const ElementNodes& nodes) {
  double sum = 0;
  for (const ReferencePoint& q : reference_points())
    sum += q.weight * jacobian_matrix(nodes, q.gradient).determinant();
  return sum;
}

ElementMatrix element_stiffness(const ElementNodes& nodes, const Material& material) {
  const double mu = material.shear_modulus();
  const double lambda = 2 * mu * material.poisson_ratio / (1 - 2 * material.poisson_ratio);
  ElementMatrix k = ElementMatrix::Zero();
  for (const ReferencePoint& q : reference_points()) {
    const Mat3 j = jacobian_matrix(nodes, q.gradient);
    const double volume = q.weight * j.determinant();
    const ShapeGradients g = j.transpose().inverse() * q.gradient;
    for (int a = 0; a < 10; ++a) {
      for (int b = a; b < 10; ++b) {
        // Isotropic stress against the strain of the test function, written out for two nodes.
        const Mat3 ab = lambda * g.col(a) * g.col(b).transpose() + mu * g.col(b) * g.col(a).transpose();
        const double shear = mu * g.col(a).dot(g.col(b));
        k.block<3, 3>(3 * a, 3 * b) += volume * (ab + shear * Mat3::Identity());
      }
    }
  }
  k.triangularView<Eigen::StrictlyLower>() = k.transpose();
  return k;
}

ElementMass element_mass(const ElementNodes& nodes, double density) {
  ElementMass m = ElementMass::Zero();
  for (const ReferencePoint& q : reference_points()) {
    m += q.weight * jacobian_matrix(nodes, q.gradient).determinant() * q.value * q.value.transpose();
  }
  return density * m;
}

}  // namespace intaglio::sound
