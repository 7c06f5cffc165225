#include <dlfcn.h>
#include <doctest/doctest.h>

#include <atomic>
#include <cmath>
#include <thread>

#include "core/portable_math.h"
#include "sound/bake/fem/block_lanczos.h"
#include "sound/bake/fem/modes.h"
#include "sound/bake/fem/tet_mesh.h"
#include "tests/sound/models.h"

using namespace intaglio;
using namespace intaglio::sound;
using test::tau;

namespace {

void check_frequencies(const Modes& modes, const std::vector<double>& hertz, double tolerance) {
  REQUIRE(modes.angular_frequency.size() >= Eigen::Index(hertz.size()));
  for (std::size_t i = 0; i < hertz.size(); ++i) {
    CAPTURE(i);
    CHECK(modes.angular_frequency[Eigen::Index(i)] / tau == doctest::Approx(hertz[i]).epsilon(tolerance));
  }
}

Eigen::MatrixXd random_columns(Eigen::Index rows, Eigen::Index columns) {
  Random random(5);
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return random.uniform(-1, 1); });
}

}  // namespace

TEST_CASE("a steel bar rings as reference/modal-frequencies.md says, within 0.3 %") {
  const auto modes = free_modes(assemble(box({1, 0.1, 0.05}, 24, 6, 4), test::steel()), {8, 20, 3000});
  REQUIRE(modes);
  check_frequencies(*modes, {257.19, 501.40, 698.11, 1160.15, 1305.99, 1339.39, 2155.01, 2323.97}, 0.003);
}

TEST_CASE("a steel cube: degenerate groups complete, within 0.6 %") {
  const auto modes = free_modes(assemble(box({1, 1, 1}, 5, 5, 5), test::steel()), {22, 20, 2760});
  REQUIRE(modes);
  std::vector<double> hertz(2, 1422.93);
  hertz.insert(hertz.end(), 3, 1916.11);
  hertz.insert(hertz.end(), 3, 1948.64);
  hertz.insert(hertz.end(), 3, 2213.49);
  check_frequencies(*modes, hertz, 0.006);
}

TEST_CASE("a ball has Lamb's frequencies and multiplicities, whatever its size and stuff") {
  struct Case {
    double poisson;
    std::vector<double> eta;
  };
  Case third{0.30, std::vector<double>(5, 2.50113)};
  third.eta.insert(third.eta.end(), 5, 2.64622);
  third.eta.insert(third.eta.end(), 3, 3.52999);
  third.eta.insert(third.eta.end(), 7, 3.86470);
  third.eta.insert(third.eta.end(), 7, 3.93740);
  Case quarter{0.25, {}};
  quarter.eta.assign(5, 2.50113);  // torsional modes do not depend on Poisson's ratio
  quarter.eta.insert(quarter.eta.end(), 5, 2.63987);
  quarter.eta.insert(quarter.eta.end(), 3, 3.42453);
  for (const Case& reference : {third, quarter}) {
    Material material = test::steel();
    material.poisson_ratio = reference.poisson;
    const double radius = 0.3;
    const double unit = std::sqrt(material.shear_modulus() / material.density) / (tau * radius);
    const auto modes = free_modes(assemble(ball(radius, 2), material), {27, 20, 4.2 * unit});
    REQUIRE(modes);
    std::vector<double> hertz;
    for (const double eta : reference.eta) hertz.push_back(eta * unit);
    check_frequencies(*modes, hertz, 0.004);
  }
}

TEST_CASE("modes are mass-normalised, ascending, true to their equation, and the same every time") {
  const ElasticSystem system = assemble(box({0.3, 0.01, 0.3}, 6, 1, 6), *find_material("ceramic"));
  const auto modes = free_modes(system, {30, 20, 20'000});
  REQUIRE(modes);
  const Eigen::MatrixXd gram = modes->shape.transpose() * system.mass_times(modes->shape);
  CHECK((gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff() < 1e-9);
  CHECK(modes->residual < 1e-6);
  for (Eigen::Index i = 1; i < modes->angular_frequency.size(); ++i) {
    CHECK(modes->angular_frequency[i] >= modes->angular_frequency[i - 1] * (1 - 1e-12));
  }
  const auto again = free_modes(system, {30, 20, 20'000});
  CHECK(again->angular_frequency == modes->angular_frequency);
  CHECK(again->shape == modes->shape);
}

TEST_CASE("no mode is missed: Sylvester's law of inertia counts the same") {
  for (const TetMesh& mesh : {box({1, 1, 1}, 3, 3, 3), ball(0.6, 1), cylinder(0.05, 1, 2, 8)}) {
    const ElasticSystem system = assemble(mesh, test::steel());
    const auto modes = free_modes(system, {1000, 20, 4000});
    REQUIRE(modes);
    const double sigma = std::pow(tau * 4000, 2);
    const auto shifted = Factorisation::factorise(system, sigma, Definiteness::indefinite);
    REQUIRE(shifted);
    CHECK(shifted->negative_eigenvalues() == modes->angular_frequency.size() + 6);
  }
}

TEST_CASE("count and range of the modes are respected") {
  const ElasticSystem system = assemble(box({1, 0.1, 0.05}, 12, 2, 1), test::steel());
  const auto few = free_modes(system, {3, 300, 20'000});
  REQUIRE(few);
  CHECK(few->angular_frequency.size() == 3);
  CHECK(few->angular_frequency[0] > tau * 300);
  const auto none = free_modes(assemble(ball(0.001, 0), test::steel()), {10, 20, 20'000});
  REQUIRE(none);
  CHECK(none->angular_frequency.size() == 0);
}

TEST_CASE("a body in two pieces is refused, with the number of its rigid modes") {
  TetMesh mesh = box({1, 1, 1}, 1, 1, 1);
  const int n = int(mesh.nodes.size());
  const std::size_t tets = mesh.tets.size();
  for (int i = 0; i < n; ++i) mesh.nodes.emplace_back(mesh.nodes[std::size_t(i)] + Vec3(3, 0, 0));
  for (std::size_t t = 0; t < tets; ++t) {
    Tet10 copy = mesh.tets[t];
    for (int& node : copy) node += n;
    mesh.tets.push_back(copy);
  }
  const auto modes = free_modes(assemble(mesh, test::steel()), {10, 20, 20'000});
  REQUIRE_FALSE(modes);
  CHECK(modes.error().message().find("found 12") != std::string::npos);
}

TEST_CASE("a factorisation solves; several may live at once and work from several threads") {
  const ElasticSystem system = assemble(box({1, 1, 1}, 3, 2, 2), test::steel());
  const double a = -1e8, b = -1e9;
  const auto check = [&](double shift, const Factorisation& factors) {
    const Eigen::MatrixXd x = random_columns(system.dofs(), 5);
    Eigen::MatrixXd y = system.stiffness_times(x) - shift * system.mass_times(x);
    factors.solve(y);
    return (y - x).norm() < 1e-6 * x.norm();
  };
  const auto factors_a = Factorisation::factorise(system, a, Definiteness::positive);
  auto factors_b = Factorisation::factorise(system, b, Definiteness::indefinite);
  REQUIRE(factors_a);
  REQUIRE(factors_b);
  CHECK(check(a, *factors_a));
  const Factorisation moved = std::move(*factors_b);
  CHECK(check(b, moved));
  std::array<bool, 3> is_right{};
  std::vector<std::thread> threads;
  for (bool& right : is_right) {
    threads.emplace_back([&] {
      const auto own = Factorisation::factorise(system, a, Definiteness::positive);
      right = own && check(a, *own);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const bool right : is_right) CHECK(right);
}

TEST_CASE("a matrix that is not positive definite is an error, not a wrong answer") {
  ElasticSystem system = assemble(box({1, 1, 1}, 2, 2, 2), test::steel());
  system.stiffness *= 0.0;
  CHECK_FALSE(Factorisation::factorise(system, 0, Definiteness::positive));
}

TEST_CASE("a body far larger or thinner than most has its modes too") {
  // Frequencies of a ball scale as 1 / radius.
  const Material plastic = *find_material("plastic");
  const auto small = free_modes(assemble(ball(0.1, 1), plastic), {.count = 8, .min_frequency = 1});
  const auto large = free_modes(assemble(ball(3, 1), plastic), {.count = 8, .min_frequency = 1});
  REQUIRE(small);
  REQUIRE(large);
  for (int k = 0; k < 8; ++k)
    CHECK(large->angular_frequency[k] * 30 == doctest::Approx(small->angular_frequency[k]).epsilon(1e-6));
  // A sheet whose first mode is far below hearing still rings, above it.
  const auto sheet = free_modes(assemble(box({2, 0.001, 0.5}, 24, 1, 6), plastic), {.count = 8});
  REQUIRE(sheet);
  CHECK(sheet->angular_frequency.size() == 8);
}

TEST_CASE("a modal analysis that is stopped ends before the next block, with an error") {
  std::atomic<bool> stop{false};
  const TetMesh plate = box({0.3, 0.01, 0.3}, 6, 1, 6);
  const ElasticSystem system = assemble(plate, *find_material("ceramic"));
  int calls = 0;
  ModeOptions options{.count = 60, .stop = &stop};
  options.progress = [&](double) {
    ++calls;
    stop = true;
  };
  const auto modes = free_modes(system, options);
  REQUIRE_FALSE(modes);
  CHECK(modes.error().message().find("stopped") != std::string::npos);
  CHECK(calls == 1);  // neither another block nor another shift
  CHECK_FALSE(free_modes(system, options));
  CHECK_FALSE(bake(plate, *find_material("ceramic"), {"plate", options}));
  CHECK_FALSE(bake_linear(plate, *find_material("ceramic"), {"plate", options}));
  CHECK(calls == 1);
  stop = false;
  options.progress = {};
  CHECK(free_modes(system, options));
}

TEST_CASE("a modal analysis leaves the process's number of BLAS threads as it was") {
  const auto set = reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"));
  const auto get = reinterpret_cast<int (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_num_threads"));
  if (!set || !get) return;  // another BLAS
  const int before = get();
  set(2);
  CHECK(free_modes(assemble(box({1, 1, 1}, 2, 2, 2), test::steel()), {.count = 8}));
  CHECK(get() == 2);
  set(before);
}

TEST_CASE("an invariant subspace ends the basis: directions lost in rounding are dropped") {
  // M = I; K has the eigenvalue 1 many times and four others once, so that from a block of eight the Krylov
  // space has twelve dimensions: eight of the first eigenvalue, and one of each other.
  constexpr int nodes = 10;
  ElasticSystem system{SparseMatrix(3 * nodes, 3 * nodes), SparseMatrix(nodes, nodes)};
  for (int k = 0; k < nodes; ++k) {
    // Neighbours are linked without mass, so that the ordering has a graph.
    for (int other = std::max(0, k - 1); other < std::min(nodes, k + 2); ++other)
      system.mass.insert(other, k) = other == k ? 1 : 0;
  }
  for (int k = 0; k < 3 * nodes; ++k) system.stiffness.insert(k, k) = k < 4 ? k + 2 : 1;
  system.mass.makeCompressed();
  system.stiffness.makeCompressed();
  const auto shifted = Factorisation::factorise(system, -1, Definiteness::positive);
  REQUIRE(shifted);
  BlockLanczos lanczos(*shifted, system, 24);
  lanczos.extend();
  lanczos.extend();
  CHECK(lanczos.size() == 12);
  lanczos.project();
  const Eigen::MatrixXd u = lanczos.ritz_vectors(0, lanczos.size());
  CHECK((u.transpose() * u - Eigen::MatrixXd::Identity(u.cols(), u.cols())).norm() < 1e-12);
}
