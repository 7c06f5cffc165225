// The free thin square plate without any mesh: Rayleigh-Ritz with products of Legendre polynomials, which
// settles which values NAFEMS FV12 is held to. Ritz values lie above the exact ones of thin-plate theory, so
// any figure above a Ritz value is not exact. Prints a table:
//   build/release/tests/test_bake -tc='*thin square plate*' -s
// Source of the energy: Leissa, "Vibration of Plates", NASA SP-160, 1969.
#include <doctest/doctest.h>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "sound/bake/fem/modes.h"
#include "sound/bake/fem/tet_mesh.h"
#include "tests/sound/models.h"

using namespace intaglio;
using namespace intaglio::sound;
using test::tau;

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Integrals over [-1, 1] of products of derivatives of orthonormal Legendre polynomials, exact by expansion:
// P_i' = sum of (2 k + 1) P_k over k = i - 1, i - 3, ...
struct Legendre {
  MatrixXd plain, first, second, with_second;  // of f g, f' g', f'' g'', f g''

  explicit Legendre(Index degree) {
    const Index n = degree + 1;
    MatrixXd derivative = MatrixXd::Zero(n, n);  // column i: P_i' in terms of P_k
    for (Index i = 0; i < n; ++i) {
      for (Index k = i - 1; k >= 0; k -= 2) derivative(k, i) = std::sqrt((2.0 * i + 1) * (2.0 * k + 1));
    }
    const MatrixXd twice = derivative * derivative;
    plain = MatrixXd::Identity(n, n);
    first = derivative.transpose() * derivative;
    second = twice.transpose() * twice;
    with_second = twice;
  }
};

// omega a^2 sqrt(rho h / D) of the first elastic modes of a free square plate, ascending.
VectorXd ritz_values(double poisson, Index degree, Index count) {
  const Legendre f(degree);
  const Index n = degree + 1;
  MatrixXd energy(n * n, n * n);
  for (Index i = 0; i < n * n; ++i) {
    for (Index j = 0; j < n * n; ++j) {
      const Index a = i / n, b = i % n, c = j / n, d = j % n;  // P_a(x) P_b(y), P_c(x) P_d(y)
      energy(i, j) =
          f.second(a, c) * f.plain(b, d) + f.plain(a, c) * f.second(b, d) +
          poisson * (f.with_second(c, a) * f.with_second(b, d) + f.with_second(a, c) * f.with_second(d, b)) +
          2 * (1 - poisson) * f.first(a, c) * f.first(b, d);
    }
  }
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(energy, Eigen::EigenvaluesOnly);
  // Three rigid motions; the side is 2.
  return 4 * solver.eigenvalues().segment(3, count).cwiseSqrt();
}

}  // namespace

TEST_CASE(
    "the free thin square plate has Gorman's frequencies, and NAFEMS FV12's listed 4.233 and 7.416 Hz lie above" *
    doctest::test_suite("statistics")) {
  const VectorXd coarse = ritz_values(0.3, 13, 6), fine = ritz_values(0.3, 17, 6);
  CHECK(((coarse - fine).array() >= -1e-8).all());               // from above
  CHECK((coarse.array() / fine.array() - 1).maxCoeff() < 1e-6);  // and they have converged
  const double h = 0.05, a = 10, rigidity = 200e9 * h * h * h / (12 * (1 - 0.09));
  const double unit = std::sqrt(rigidity / (8000 * h)) / (tau * a * a);
  const std::array<double, 6> gorman{13.468, 19.596, 24.270, 34.801, 34.801, 61.093},
      nafems{1.622, 2.360, 2.922, 4.233, 4.233, 7.416};
  Material material = test::steel();
  material.density = 8000;
  const auto modes = free_modes(assemble(box({a, h, a}, 28, 1, 28), material), {6, 0.2, 8});
  REQUIRE(modes);
  REQUIRE(modes->angular_frequency.size() == 7);  // the sixth is one of a pair
  for (Index i = 0; i < 6; ++i) {
    const double hertz = fine[i] * unit, ours = modes->angular_frequency[i] / tau;
    const auto k = std::size_t(i);
    MESSAGE(fmt::format(
        "lambda {:.4f}: {:.4f} Hz; Gorman {:.3f}; listed {:.3f} ({:+.2f} %); ours {:.4f} ({:+.3f} %, "
        "{:+.3f} % of the listed)",
        fine[i], hertz, gorman[k], nafems[k], 100 * (nafems[k] / hertz - 1), ours, 100 * (ours / hertz - 1),
        100 * (ours / nafems[k] - 1)));
    CHECK(fine[i] == doctest::Approx(gorman[k]).epsilon(2e-4));
    CHECK(std::abs(ours / hertz - 1) < 0.005);
    if (i >= 3) CHECK(nafems[k] > 1.007 * hertz);
  }
}
