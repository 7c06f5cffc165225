// The ten-node isoparametric tetrahedron: stiffness and mass of one element of linear isotropic elasticity.
//
// Degrees of freedom are ordered node by node: (x, y, z) of node 0, then of node 1, and so on. SI units:
// stiffness N/m, mass kg. Source: Zienkiewicz & Taylor, "The Finite Element Method", vol. 1. About 15
// microseconds an element.
#pragma once

#include <array>

#include "intaglio/core/material.h"
#include "intaglio/sound/fem/tet_mesh.h"

namespace intaglio::sound {

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

}  // namespace intaglio::sound
