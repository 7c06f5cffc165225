// The eigensolver of modal analysis beside ARPACK: bench_bake [--json] [NODES_A_SIDE...].
//
// For each size a steel block, 2 x 0.3 x 1 m, whose modes are single, and a cube, whose modes come in
// pairs and triples. Both solvers find the 106 lowest modes of the same matrices, from the same shift, with
// the same factorisation (block_lanczos.h) on one thread. ARPACK runs in shift-invert mode (`dsaupd`, mode 3)
// with a basis twice the number of modes, as its manual advises, to the tolerance of ours, 1e-8. Prints the
// thread's CPU seconds of each whole analysis and of one factorisation, the solved columns of ARPACK, and the
// largest relative difference of a frequency. Needs libarpack2-dev when built.
#include <fmt/format.h>
#include <Eigen/Core>
#include <algorithm>
#include <arpack/arpack.hpp>
#include <cmath>
#include <optional>
#include <vector>

#include "bench/arguments.h"
#include "bench/brick.h"
#include "core/portable_math.h"
#include "intaglio/material.h"
#include "sound/bake/fem/block_lanczos.h"
#include "sound/bake/fem/elastic_system.h"
#include "sound/bake/fem/modes.h"
#include "sound/bake/fem/tet_mesh.h"

using namespace intaglio;
using namespace intaglio::sound;
using bench::cpu_seconds;
using Eigen::MatrixXd;

namespace {

constexpr int modes = 100, rigid = 6;
constexpr double tolerance = 1e-8;
const double shift = -std::pow(2 * EIGEN_PI * 20'000 / 20, 2);  // as free_modes()

struct ArpackResult {
  std::vector<double> frequency;  // rad/s, ascending, without the rigid modes
  int solves = 0;
};

ArpackResult arpack_modes(const ElasticSystem& system, const Factorisation& shifted) {
  const auto n = a_int(system.dofs());
  const a_int wanted = modes + rigid, basis = 2 * wanted + 1;
  std::vector<double> residual(std::size_t(n), 0.0), work(std::size_t(3 * n), 0.0);
  std::vector<double> small(std::size_t(basis * (basis + 8)), 0.0), values(std::size_t(wanted), 0.0);
  MatrixXd vectors(n, basis);
  a_int parameters[11] = {1, 0, 1000, 1, 0, 0, 3}, pointers[14] = {}, action = 0, info = 1;
  Random random(1);
  for (double& value : residual) value = random.uniform(-1, 1);
  ArpackResult result;
  while (action != 99) {
    arpack::saupd(action, arpack::bmat::generalized, n, arpack::which::largest_magnitude, wanted, tolerance,
                  residual.data(), basis, vectors.data(), n, parameters, pointers, work.data(), small.data(),
                  a_int(small.size()), info);
    const auto column = [&](a_int pointer) {
      return Eigen::Map<Eigen::VectorXd>(work.data() + pointer - 1, n);
    };
    if (action == 2) {  // y = M x
      column(pointers[1]) = system.mass_times(column(pointers[0]));
    } else if (action == -1 || action == 1) {  // y = (K - shift M)^-1 M x; M x may be there already
      MatrixXd x = action == 1 ? MatrixXd(column(pointers[2])) : system.mass_times(column(pointers[0]));
      shifted.solve(x);
      column(pointers[1]) = x;
      ++result.solves;
    }
  }
  std::vector<a_int> selected(std::size_t(basis), 0);
  arpack::seupd(true, arpack::howmny::ritz_vectors, selected.data(), values.data(), vectors.data(), n, shift,
                arpack::bmat::generalized, n, arpack::which::largest_magnitude, wanted, tolerance,
                residual.data(), basis, vectors.data(), n, parameters, pointers, work.data(), small.data(),
                a_int(small.size()), info);
  if (info != 0) fmt::print(stderr, "bench_bake: ARPACK ended with code {}\n", info);
  std::sort(values.begin(), values.end());
  for (a_int k = rigid; k < wanted; ++k) result.frequency.push_back(std::sqrt(values[std::size_t(k)]));
  return result;
}

struct Row {
  const char* body;
  Eigen::Index dofs = 0;
  double factorisation = 0, ours = 0, arpack = 0;  // CPU seconds, the last two with a factorisation
  int solves = 0;
  double difference = 0;  // relative, of frequencies
};

template <class Work>
double seconds_of(const Work& work) {
  const double start = cpu_seconds();
  work();
  return cpu_seconds() - start;
}

Row measure(const char* body, const TetMesh& mesh) {
  const SingleThreadedBlas single;
  const ElasticSystem system = assemble(mesh, *find_material("steel"));
  Row row{body, system.dofs()};
  std::optional<Factorisation> shifted;
  row.factorisation = seconds_of(
      [&] { shifted = std::move(*Factorisation::factorise(system, shift, Definiteness::positive)); });
  Modes ours;
  row.ours = seconds_of([&] { ours = *free_modes(system, {.count = modes}); });
  ArpackResult theirs;
  row.arpack = row.factorisation + seconds_of([&] { theirs = arpack_modes(system, *shifted); });
  row.solves = theirs.solves;
  for (std::size_t k = 0; k < theirs.frequency.size(); ++k) {
    const double reference = ours.angular_frequency[Eigen::Index(k)];
    row.difference = std::max(row.difference, std::abs(theirs.frequency[k] / reference - 1));
  }
  return row;
}

}  // namespace

int main(int argc, char** argv) {
  const auto arguments = bench::arguments(argc, argv, "bench_bake", 4, {8, 16, 24});
  if (!arguments) return 2;
  if (!arguments->json) {
    fmt::print("{:>6} {:>9} {:>15} {:>10} {:>10} {:>7} {:>14} {:>12}\n", "body", "unknowns", "factorise, s",
               "ours, s", "ARPACK, s", "ratio", "ARPACK solves", "difference");
  }
  for (const int side : arguments->sizes) {
    const int layers = std::max(2, side / 4);
    for (const Row& row : {measure("block", box({2, 0.3, 1}, 2 * side, layers, side)),
                           measure("cube", box({1, 1, 1}, side, side, side))}) {
      if (arguments->json) {
        fmt::print(
            "{{\"body\": \"{}\", \"unknowns\": {}, \"factorise_s\": {:.3f}, \"ours_s\": {:.3f}, "
            "\"arpack_s\": {:.3f}, \"ratio\": {:.2f}, \"arpack_solves\": {}, \"difference\": {:.1e}}}\n",
            row.body, row.dofs, row.factorisation, row.ours, row.arpack, row.arpack / row.ours, row.solves,
            row.difference);
      } else {
        fmt::print("{:>6} {:>9} {:>15.3f} {:>10.3f} {:>10.3f} {:>7.2f} {:>14} {:>12.1e}\n", row.body,
                   row.dofs, row.factorisation, row.ours, row.arpack, row.arpack / row.ours, row.solves,
                   row.difference);
      }
    }
  }
}
