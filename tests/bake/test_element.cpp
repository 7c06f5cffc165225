#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/portable_math.h"
#include "sound/bake/fem/elastic_system.h"
#include "tests/sound/models.h"

using namespace intaglio;
using namespace intaglio::sound;

namespace {

double factorial(int n) {
  return std::tgamma(n + 1.0);
}

// A tetrahedron with all ten nodes displaced: curved edges on every side.
ElementNodes bent_tet() {
  ElementNodes nodes;
  nodes.leftCols<4>() << 0, 1, 0.1, 0.2, 0, 0.1, 0.9, 0.3, 0, 0, -0.1, 1.1;
  Random random(7);
  for (int e = 0; e < 6; ++e) {
    const auto& [i, j] = tet_edges[std::size_t(e)];
    nodes.col(4 + e) = 0.5 * (nodes.col(i) + nodes.col(j)) +
                       0.03 * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  }
  return nodes;
}

using Displacement = Eigen::Matrix<double, 30, 1>;

// Node by node u = linear * x + shift.
Displacement displacement(const ElementNodes& nodes, const Mat3& linear, const Vec3& shift) {
  Displacement u;
  for (int a = 0; a < 10; ++a) u.segment<3>(3 * a) = linear * nodes.col(a) + shift;
  return u;
}

}  // namespace

TEST_CASE("the quadrature is exact for every monomial up to degree 5") {
  for (int i = 0; i <= 5; ++i) {
    for (int j = 0; i + j <= 5; ++j) {
      for (int k = 0; i + j + k <= 5; ++k) {
        double sum = 0;
        for (const QuadraturePoint& q : tet_quadrature()) {
          sum += q.weight * std::pow(q.barycentric[1], i) * std::pow(q.barycentric[2], j) *
                 std::pow(q.barycentric[3], k);
        }
        const double exact = 6 * factorial(i) * factorial(j) * factorial(k) / factorial(i + j + k + 3);
        CAPTURE(i);
        CAPTURE(j);
        CAPTURE(k);
        CHECK(sum == doctest::Approx(exact).epsilon(1e-13));
      }
    }
  }
}

TEST_CASE("shape functions are one at their own node, and add up to one everywhere") {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const double a = random.uniform(), b = random.uniform(), c = random.uniform();
    const std::array<double, 4> at{1 - a - b - c, a, b, c};
    CHECK(shape_values(at).sum() == doctest::Approx(1));
    CHECK(reference_gradients(at).rowwise().sum().norm() < 1e-12);
  }
  for (std::size_t corner = 0; corner < 4; ++corner) {
    std::array<double, 4> at{};
    at[corner] = 1;
    CHECK((shape_values(at) - ShapeValues::Unit(Eigen::Index(corner))).norm() < 1e-15);
  }
  for (std::size_t e = 0; e < 6; ++e) {
    std::array<double, 4> at{};
    at[std::size_t(tet_edges[e][0])] = at[std::size_t(tet_edges[e][1])] = 0.5;
    CHECK((shape_values(at) - ShapeValues::Unit(Eigen::Index(4 + e))).norm() < 1e-15);
  }
}

TEST_CASE("an element resists no rigid motion, and nothing else is free") {
  const ElementMatrix k = element_stiffness(bent_tet(), test::steel());
  CHECK((k - k.transpose()).norm() == 0);
  const Eigen::SelfAdjointEigenSolver<ElementMatrix> solver(k);
  const double stiffest = solver.eigenvalues()[29];
  CHECK(solver.eigenvalues().head<6>().cwiseAbs().maxCoeff() < 1e-12 * stiffest);
  CHECK(solver.eigenvalues()[6] > 1e-4 * stiffest);
  for (int axis = 0; axis < 3; ++axis) {
    Mat3 spin = Mat3::Zero();
    spin((axis + 1) % 3, (axis + 2) % 3) = -1;
    spin((axis + 2) % 3, (axis + 1) % 3) = 1;
    CHECK((k * displacement(bent_tet(), spin, Vec3::Unit(axis))).norm() < 1e-12 * stiffest);
  }
}

TEST_CASE("patch: the energy of a constant strain is exact even in a bent element") {
  const Material material = test::steel();
  const ElementNodes nodes = bent_tet();
  const ElementMatrix k = element_stiffness(nodes, material);
  const double mu = material.shear_modulus();
  const double lambda = 2 * mu * material.poisson_ratio / (1 - 2 * material.poisson_ratio);
  Random random(2);
  for (int trial = 0; trial < 20; ++trial) {
    const Mat3 linear = Mat3::NullaryExpr([&] { return random.uniform(-1, 1); });
    const Mat3 strain = 0.5 * (linear + linear.transpose());
    const double energy =
        (0.5 * lambda * std::pow(strain.trace(), 2) + mu * strain.squaredNorm()) * element_volume(nodes);
    const Displacement u = displacement(nodes, linear, Vec3::Ones());
    CHECK(0.5 * u.dot(k * u) == doctest::Approx(energy).epsilon(1e-10));
  }
}

TEST_CASE("the mass of an element is density times volume, and its rigid spin has the right inertia") {
  const ElementNodes nodes = bent_tet();
  const ElementMass m = element_mass(nodes, 7850);
  CHECK(m.sum() == doctest::Approx(7850 * element_volume(nodes)));
  CHECK(Eigen::SelfAdjointEigenSolver<ElementMass>(m).eigenvalues()[0] > 0);
  // A straight tetrahedron's second moment has a closed form: rho V / 20 (sum x_i^2 + (sum x_i)^2).
  ElementNodes straight = nodes;
  for (int e = 0; e < 6; ++e) {
    straight.col(4 + e) =
        0.5 * (nodes.col(tet_edges[std::size_t(e)][0]) + nodes.col(tet_edges[std::size_t(e)][1]));
  }
  const Eigen::Matrix<double, 10, 1> x = straight.row(0);
  const Eigen::Vector4d corner = x.head<4>();
  const double exact =
      7850 * element_volume(straight) / 20 * (corner.squaredNorm() + std::pow(corner.sum(), 2));
  CHECK(x.dot(element_mass(straight, 7850) * x) == doctest::Approx(exact).epsilon(1e-12));
}
