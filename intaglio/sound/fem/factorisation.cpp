#include "intaglio/sound/fem/factorisation.h"

#include <dlfcn.h>
#include <dmumps_c.h>
#include <metis.h>

#include <cassert>
#include <mutex>
#include <vector>

namespace intaglio::sound {

namespace {

std::mutex mumps_mutex;

void use_one_blas_thread() {
  // Only OpenBLAS has threads to switch off; another BLAS does not have the symbol.
  using SetThreads = void (*)(int);
  static const auto set_threads =
      reinterpret_cast<SetThreads>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"));
  if (set_threads) set_threads(1);
}

// The place of each degree of freedom in the elimination order, from 1. MUMPS as Debian builds it lacks
// METIS; and the graph of the nodes is a ninth of the graph of the degrees of freedom.
std::vector<MUMPS_INT> elimination_order(const SparseMatrix& matrix) {
  auto nodes = static_cast<idx_t>(matrix.cols() / 3);
  std::vector<idx_t> start{0}, neighbours;
  for (int node = 0; node < nodes; ++node) {
    int last = -1;
    for (SparseMatrix::InnerIterator entry(matrix, 3 * node); entry; ++entry) {
      const int other = static_cast<int>(entry.row()) / 3;
      if (other != node && other != last) neighbours.push_back(last = other);
    }
    start.push_back(static_cast<idx_t>(neighbours.size()));
  }
  std::vector<idx_t> order(start.size() - 1), place(start.size() - 1);
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  METIS_NodeND(&nodes, start.data(), neighbours.data(), nullptr, options, order.data(), place.data());
  std::vector<MUMPS_INT> result;
  for (const idx_t p : place) {
    for (int axis = 0; axis < 3; ++axis) result.push_back(static_cast<MUMPS_INT>(3 * p + axis + 1));
  }
  return result;
}

Error explain(const DMUMPS_STRUC_C& mumps) {
  const int code = mumps.infog[0];
  switch (code) {
    case -10:
    case -40:
      return {"modal analysis", "the matrix is singular or not positive definite",
              "every part of the mesh must be connected, and every element have positive volume"};
    case -7:
    case -13:
    case -19:
      return {"modal analysis", "there is not enough memory to factorise the matrix", "use a coarser mesh"};
    default:
      return {"modal analysis", fmt::format("MUMPS failed with code {} ({})", code, mumps.infog[1]), ""};
  }
}

}  // namespace

struct Factorisation::Instance {
  mutable DMUMPS_STRUC_C mumps{};
  std::vector<MUMPS_INT> rows, columns, order;
  std::vector<double> values;

  void call(int job) const {
    const std::lock_guard lock(mumps_mutex);
    mumps.job = job;
    dmumps_c(&mumps);
  }
  ~Instance() { call(-2); }
};

Factorisation::Factorisation(std::unique_ptr<Instance> instance) : instance_(std::move(instance)) {}
Factorisation::Factorisation(Factorisation&&) noexcept = default;
Factorisation& Factorisation::operator=(Factorisation&&) noexcept = default;
Factorisation::~Factorisation() = default;

Result<Factorisation> Factorisation::of(const SparseMatrix& matrix, Definiteness definiteness) {
  assert(matrix.rows() == matrix.cols() && matrix.cols() % 3 == 0);
  use_one_blas_thread();
  auto instance = std::make_unique<Instance>();
  DMUMPS_STRUC_C& mumps = instance->mumps;
  const auto icntl = [&mumps](int number) -> MUMPS_INT& {
    return mumps.icntl[number - 1];
  };  // numbered as in its manual
  mumps.par = 1;
  mumps.sym = definiteness == Definiteness::positive ? 1 : 2;
  mumps.comm_fortran = -987654;  // MPI_COMM_WORLD of the sequential build
  instance->call(-1);

  for (int column = 0; column < matrix.cols(); ++column) {
    for (SparseMatrix::InnerIterator entry(matrix, column); entry; ++entry) {
      if (entry.row() < column) continue;
      instance->rows.push_back(static_cast<MUMPS_INT>(entry.row()) + 1);
      instance->columns.push_back(column + 1);
      instance->values.push_back(entry.value());
    }
  }
  instance->order = elimination_order(matrix);
  mumps.n = static_cast<MUMPS_INT>(matrix.cols());
  mumps.nnz = static_cast<MUMPS_INT8>(instance->values.size());
  mumps.irn = instance->rows.data();
  mumps.jcn = instance->columns.data();
  mumps.a = instance->values.data();
  mumps.perm_in = instance->order.data();
  for (int stream = 1; stream <= 4; ++stream) icntl(stream) = 0;  // print nothing
  icntl(7) = 1;                                                   // the order is ours
  icntl(14) = 40;                                                 // per cent of memory to spare for pivoting
  icntl(28) = 1;                                                  // analyse sequentially
  instance->call(4);
  if (mumps.infog[0] < 0) return tl::unexpected<Error>(explain(mumps));
  return Factorisation(std::move(instance));
}

void Factorisation::solve(Eigen::MatrixXd& b) const {
  DMUMPS_STRUC_C& mumps = instance_->mumps;
  assert(b.rows() == mumps.n);
  mumps.rhs = b.data();
  mumps.nrhs = static_cast<MUMPS_INT>(b.cols());
  mumps.lrhs = mumps.n;
  instance_->call(3);
}

int Factorisation::negative_eigenvalues() const {
  return instance_->mumps.infog[11];
}

}  // namespace intaglio::sound
