#include "sound/bake/fem/block_lanczos.h"

#include <dlfcn.h>
#include <dmumps_c.h>
#include <metis.h>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>
#include <csignal>
#include <mutex>
#include <numeric>
#include <vector>

#include "core/portable_math.h"

// BLAS as Fortran has it: c = alpha op(a) op(b) + beta c.
extern "C" void dgemm_(const char* op_a, const char* op_b, const int* m, const int* n, const int* k,
                       const double* alpha, const double* a, const int* lda, const double* b, const int* ldb,
                       const double* beta, double* c, const int* ldc);

namespace intaglio::sound {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr Index chunk_columns = 64;
constexpr double ritz_tolerance = 1e-8;  // residual of a Ritz pair, relative; its value errs by the square
// A Gram matrix of eight columns is rounded by some 1e-15 of its largest eigenvalue: smaller eigenvalues are
// noise, and their vectors are neither of unit length nor orthogonal to the basis. Bodies are above 1e-6.
constexpr double gram_noise = 1e-14;

std::mutex mumps_mutex;

// OpenBLAS's setting of the process, found by name, since another BLAS does not have it.
template <class Function>
Function* blas_function(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_DEFAULT, name));  // Process-wide: only looked up
}
struct BlasThreads {
  int (*get)() = blas_function<int()>("openblas_get_num_threads");
  void (*set)(int) = blas_function<void(int)>("openblas_set_num_threads");
  std::mutex mutex;
  int users = 0, hosts = 0;  // objects that live; the host's number of threads
};
BlasThreads& blas_threads() {
  static BlasThreads threads;
  return threads;
}

// The elimination position of each degree of freedom, from 1. Debian's MUMPS lacks METIS; and the graph of
// the nodes is a ninth of the graph of the degrees of freedom.
std::vector<MUMPS_INT> elimination_order(const SparseMatrix& node_matrix) {
  auto nodes = idx_t(node_matrix.cols());
  std::vector<idx_t> start{0}, neighbours;
  for (int node = 0; node < nodes; ++node) {
    for (SparseMatrix::InnerIterator entry(node_matrix, node); entry; ++entry) {
      if (entry.row() != node) neighbours.push_back(idx_t(entry.row()));
    }
    start.push_back(idx_t(neighbours.size()));
  }
  std::vector<idx_t> order(start.size() - 1), place(start.size() - 1);
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  // While METIS runs, SIGTERM is its own (GKlib raises it for errors): one that is sent to the process then
  // ends METIS instead, without an order. It is passed on to the handler that METIS has put back.
  constexpr int attempts = 3;
  int status = METIS_ERROR;
  for (int k = 0; k < attempts && status == METIS_ERROR; ++k) {
    status =
        METIS_NodeND(&nodes, start.data(), neighbours.data(), nullptr, options, order.data(), place.data());
    if (status == METIS_ERROR) std::raise(SIGTERM);
  }
  if (status != METIS_OK) std::iota(place.begin(), place.end(), idx_t{0});  // slow, but an order
  std::vector<MUMPS_INT> result;
  for (const idx_t p : place) {
    for (int axis = 0; axis < 3; ++axis) result.push_back(MUMPS_INT(3 * p + axis + 1));
  }
  return result;
}

struct Triplets {
  std::vector<MUMPS_INT> rows, columns;
  std::vector<double> values;
};

// The lower triangle of K - shift * M.
Triplets shifted_entries(const ElasticSystem& system, double shift) {
  Triplets entries;
  const auto count = std::size_t(system.stiffness.nonZeros());
  entries.rows.reserve(count);
  entries.columns.reserve(count);
  entries.values.reserve(count);
  for (int column = 0; column < system.dofs(); ++column) {
    SparseMatrix::InnerIterator mass(system.mass, column / 3);
    for (SparseMatrix::InnerIterator entry(system.stiffness, column); entry; ++entry) {
      const int row = int(entry.row());
      while (mass && mass.row() < row / 3) ++mass;
      const bool has_mass = mass && mass.row() == row / 3 && row % 3 == column % 3;
      entries.rows.push_back(row + 1);
      entries.columns.push_back(column + 1);
      entries.values.push_back(entry.value() - (has_mass ? shift * mass.value() : 0.0));
    }
  }
  return entries;
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

SingleThreadedBlas::SingleThreadedBlas() {
  BlasThreads& blas = blas_threads();
  if (!blas.get || !blas.set) return;
  const std::lock_guard lock(blas.mutex);
  if (blas.users++ > 0) return;
  blas.hosts = blas.get();
  blas.set(1);
}

SingleThreadedBlas::~SingleThreadedBlas() {
  BlasThreads& blas = blas_threads();
  if (!blas.get || !blas.set) return;
  const std::lock_guard lock(blas.mutex);
  if (--blas.users == 0) blas.set(blas.hosts);
}

struct Factorisation::Instance {
  mutable DMUMPS_STRUC_C mumps{};
  void call(int job) const {
    const std::lock_guard lock(mumps_mutex);
    const SingleThreadedBlas single;
    mumps.job = job;
    dmumps_c(&mumps);
  }
  ~Instance() { call(-2); }
};

Factorisation::Factorisation(std::unique_ptr<Instance> instance) : instance_(std::move(instance)) {}
Factorisation::Factorisation(Factorisation&&) noexcept = default;
Factorisation& Factorisation::operator=(Factorisation&&) noexcept = default;
Factorisation::~Factorisation() = default;

Result<Factorisation> Factorisation::factorise(const ElasticSystem& system, double shift,
                                               Definiteness definiteness, const std::atomic<bool>* stop) {
  auto instance = std::make_unique<Instance>();
  DMUMPS_STRUC_C& mumps = instance->mumps;
  // Numbered as in its manual.
  const auto icntl = [&mumps](int number) -> MUMPS_INT& { return mumps.icntl[number - 1]; };
  mumps.par = 1;
  mumps.sym = definiteness == Definiteness::positive ? 1 : 2;
  mumps.comm_fortran = -987654;  // MPI_COMM_WORLD of the sequential build
  instance->call(-1);

  Triplets entries = shifted_entries(system, shift);
  std::vector<MUMPS_INT> order = elimination_order(system.mass);
  mumps.n = MUMPS_INT(system.dofs());
  mumps.nnz = MUMPS_INT8(entries.values.size());
  mumps.irn = entries.rows.data();
  mumps.jcn = entries.columns.data();
  mumps.a = entries.values.data();
  mumps.perm_in = order.data();
  for (int stream = 1; stream <= 4; ++stream) icntl(stream) = 0;  // print nothing
  icntl(7) = 1;                                                   // the order is ours
  // Per cent of memory to spare: a positive matrix is not pivoted.
  icntl(14) = definiteness == Definiteness::positive ? 10 : 40;
  icntl(28) = 1;                  // analyse sequentially
  for (const int job : {1, 2}) {  // analyse, factorise
    if (stop_requested(stop)) return bake_stopped();
    instance->call(job);
    if (mumps.infog[0] < 0) break;
  }
  // Solving needs only the factors, and the entries are freed when this returns.
  mumps.irn = mumps.jcn = mumps.perm_in = nullptr;
  mumps.a = nullptr;
  if (mumps.infog[0] < 0) return tl::unexpected<Error>(explain(mumps));
  return Factorisation(std::move(instance));
}

void Factorisation::solve(Eigen::MatrixXd& b) const {
  DMUMPS_STRUC_C& mumps = instance_->mumps;
  assert(b.rows() == mumps.n);
  mumps.rhs = b.data();
  mumps.nrhs = MUMPS_INT(b.cols());
  mumps.lrhs = mumps.n;
  instance_->call(3);
}

int Factorisation::negative_eigenvalues() const {
  return instance_->mumps.infog[11];
}

void TallBasis::append(const MatrixXd& columns) {
  assert(columns.rows() == rows_);
  for (Index k = 0; k < columns.cols(); ++k, ++size_) {
    if (size_ % chunk_columns == 0) chunks_.emplace_back(rows_, chunk_columns);
    chunks_.back().col(size_ % chunk_columns) = columns.col(k);
  }
}

// Calls visit(data, count, position after `first`) for the columns of each chunk.
template <class Visit>
void TallBasis::each_chunk(Index first, Visit visit) const {
  const SingleThreadedBlas single;
  for (Index at = first; at < size_;) {
    const Index in_chunk = at % chunk_columns;
    const Index count = std::min(chunk_columns - in_chunk, size_ - at);
    visit(chunks_[std::size_t(at / chunk_columns)].col(in_chunk).data(), int(count), at - first);
    at += count;
  }
}

MatrixXd TallBasis::transposed_times(const MatrixXd& x, Index first) const {
  MatrixXd result(size_ - first, x.cols());
  if (x.cols() == 0) return result;
  const auto n = int(rows_), width = int(x.cols()), height = int(result.rows());
  const double one = 1, zero = 0;
  each_chunk(first, [&](const double* columns, int count, Index place) {
    dgemm_("T", "N", &count, &width, &n, &one, columns, &n, x.data(), &n, &zero, result.data() + place,
           &height);
  });
  return result;
}

void TallBasis::subtract(const MatrixXd& h, MatrixXd& x, Index first) const {
  assert(h.rows() == size_ - first && h.cols() == x.cols());
  if (x.cols() == 0) return;
  const auto n = int(rows_), width = int(x.cols()), height = int(h.rows());
  const double minus_one = -1, one = 1;
  each_chunk(first, [&](const double* columns, int count, Index place) {
    dgemm_("N", "N", &n, &width, &count, &minus_one, columns, &n, h.data() + place, &height, &one, x.data(),
           &n);
  });
}

MatrixXd TallBasis::times(const MatrixXd& y) const {
  MatrixXd result = MatrixXd::Zero(rows_, y.cols());
  subtract(-y, result);
  return result;
}

BlockLanczos::BlockLanczos(const Factorisation& shifted, const ElasticSystem& system, Index max_size)
    : shifted_(shifted), system_(system), max_size_(max_size), basis_(system.dofs()) {
  Random random(1);
  next_ = MatrixXd::NullaryExpr(system.dofs(), block_size, [&] { return random.uniform(-1, 1); });
  // One application of A damps the stiff components, which no wanted mode contains.
  next_ = system_.mass_times(next_);
  shifted_.solve(next_);
  orthonormalise();
}

void BlockLanczos::extend() {
  const Index first = size(), width = next_.cols();
  basis_.append(next_);
  next_ = mass_next_;
  shifted_.solve(next_);
  projected_.conservativeResizeLike(MatrixXd::Zero(size(), size()));
  const auto orthogonalise_from = [&](Index from) {
    const MatrixXd h = basis_.transposed_times(system_.mass_times(next_), from);
    basis_.subtract(h, next_, from);
    projected_.block(from, first, h.rows(), width) += h;
  };
  // In exact arithmetic only the last two blocks matter; the full pass removes the rounding error of the
  // other blocks, which would otherwise grow exponentially.
  orthogonalise_from(std::max<Index>(0, first - block_size));
  orthogonalise_from(0);
  projected_.block(first, 0, width, first) = projected_.block(0, first, first, width).transpose();
  coupling_ = orthonormalise();
}

// A V = V T + X B E^T, with X the next block and E the last block's columns of the identity: the Ritz pair
// (theta, V s) of T s = theta s has the residual X B E^T s, of norm |B s_k|, where s_k are the last rows of
// s. For symmetric A the error of theta is its square over the distance to the next eigenvalue.
void BlockLanczos::project() {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(projected_);
  values_ = solver.eigenvalues().reverse();
  vectors_ = solver.eigenvectors().rowwise().reverse();
  const Index width = coupling_.cols();
  converged_ = 0;
  while (converged_ < size() &&
         (coupling_ * vectors_.col(converged_).tail(width)).norm() <= ritz_tolerance * values_[converged_]) {
    ++converged_;
  }
}

MatrixXd BlockLanczos::ritz_vectors(Index first, Index count) const {
  return basis_.times(vectors_.middleCols(first, count));
}

// Makes the columns X of the next block M-orthonormal and returns R with X_before = X_after R.
//
// The Gram matrix G = X^T M X = Q D Q^T gives X <- X Q D^(-1/2) and R <- D^(1/2) Q^T R. Directions whose
// eigenvalue is lost in the rounding of G depend on the others and are dropped. The second pass repairs what
// rounding left of the first: small D are known to few digits, but after a division by their roots all
// columns are of like length, and the Gram matrix is nearly the identity.
MatrixXd BlockLanczos::orthonormalise() {
  mass_next_ = system_.mass_times(next_);
  MatrixXd r = MatrixXd::Identity(next_.cols(), next_.cols());
  for (int pass = 0; pass < 2; ++pass) {
    const MatrixXd gram = next_.transpose() * mass_next_;
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(gram);
    const Eigen::VectorXd& d = solver.eigenvalues();
    Index kept = 0;
    while (kept < d.size() && d[d.size() - 1 - kept] > gram_noise * d[d.size() - 1]) ++kept;
    const MatrixXd q = solver.eigenvectors().rightCols(kept);
    const Eigen::VectorXd root = d.tail(kept).cwiseSqrt();
    r = root.asDiagonal() * q.transpose() * r;
    const MatrixXd rotation = q * root.cwiseInverse().asDiagonal();
    next_ = next_ * rotation;
    mass_next_ = mass_next_ * rotation;
  }
  return r;
}

}  // namespace intaglio::sound
