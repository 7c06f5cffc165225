// The stiffness and mass matrices of a whole body: K U = M U Lambda is what modal analysis solves.
#pragma once

#include <Eigen/SparseCore>
#include <algorithm>
#include <array>

#include "intaglio/material.h"
#include "sound/bake/fem/tet_mesh.h"

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

// The ten-node isoparametric tetrahedron: stiffness and mass of one element of linear isotropic elasticity.
//
// Degrees of freedom are ordered node by node: (x, y, z) of node 0, then of node 1, and so on. SI units:
// stiffness N/m, mass kg. Source: Zienkiewicz & Taylor, "The Finite Element Method", vol. 1. About 15
// microseconds an element.

struct QuadraturePoint {
  std::array<double, 4> barycentric;
  double weight;  // fraction of the volume; all weights add up to 1
};

// Fourteen points, exact for polynomials up to degree 5. Source: Walkington, "Quadrature on simplices of
// arbitrary dimension", 2000.
const std::array<QuadraturePoint, 14>& tet_quadrature();

using ElementNodes = Eigen::Matrix<double, 3, 10>;    // positions, one node a column
using ShapeValues = Eigen::Matrix<double, 10, 1>;     // N_a
using ShapeGradients = Eigen::Matrix<double, 3, 10>;  // grad N_a
using ElementMatrix = Eigen::Matrix<double, 30, 30>;
using ElementMass = Eigen::Matrix<double, 10, 10>;  // the same for x, y and z

ElementNodes element_nodes(const TetMesh& mesh, const Tet10& tet);

// The ten shape functions at barycentric coordinates, and their gradients in the reference coordinates (b1,
// b2, b3).
ShapeValues shape_values(const std::array<double, 4>& barycentric);
ShapeGradients reference_gradients(const std::array<double, 4>& barycentric);

// Determinant of the Jacobian (6 x local volume, m^3) at barycentric coordinates: positive in a valid
// element.
double jacobian(const ElementNodes& nodes, const std::array<double, 4>& barycentric);

double element_volume(const ElementNodes& nodes);
ElementMatrix element_stiffness(const ElementNodes& nodes, const Material& material);
ElementMass element_mass(const ElementNodes& nodes, double density);

// Element matrices added up into the matrices of a whole body, for elements of N nodes each.

template <int N>
struct ElementSystem {
  Eigen::Matrix<double, 3 * N, 3 * N> stiffness;
  Eigen::Matrix<double, N, N> mass;  // the same for every axis
};

namespace assembling {

using Neighbours = std::vector<std::vector<int>>;  // of each node, itself included, ascending

// All-zero matrices of these nodes.
ElasticSystem zero_system(const Neighbours& neighbours);

}  // namespace assembling

// `element_of(e)` gives the matrices of element e, whose nodes are `elements[e]`; a node may be named twice
// if the matrices give its second naming nothing.
template <int N, class ElementOf>
ElasticSystem assemble_elements(std::size_t node_count, const std::vector<std::array<int, N>>& elements,
                                ElementOf element_of) {
  assembling::Neighbours neighbours(node_count);
  for (const auto& element : elements) {
    for (const int a : element)
      neighbours[std::size_t(a)].insert(neighbours[std::size_t(a)].end(), element.begin(), element.end());
  }
  for (auto& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  ElasticSystem system = assembling::zero_system(neighbours);
  double* const stiffness = system.stiffness.valuePtr();
  double* const mass = system.mass.valuePtr();
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const ElementSystem<N> element = element_of(e);
    for (int a = 0; a < N; ++a) {
      const int node = elements[e][std::size_t(a)];
      const auto& list = neighbours[std::size_t(node)];
      const auto place_of = [&](int other) {
        return std::lower_bound(list.begin(), list.end(), other) - list.begin();
      };
      const auto diagonal = place_of(node);
      for (int b = 0; b < N; ++b) {
        const int other = elements[e][std::size_t(b)];
        const auto place = place_of(other);
        mass[system.mass.outerIndexPtr()[node] + place] += element.mass(b, a);
        if (other < node) continue;
        for (int axis = 0; axis < 3; ++axis) {
          // A column begins at its own diagonal: `axis` rows of the first block are above it.
          double* const rows =
              stiffness + system.stiffness.outerIndexPtr()[3 * node + axis] + 3 * (place - diagonal) - axis;
          for (int row = other == node ? axis : 0; row < 3; ++row)
            rows[row] += element.stiffness(3 * b + row, 3 * a + axis);
        }
      }
    }
  }
  return system;
}

}  // namespace intaglio::sound
