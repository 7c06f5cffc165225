// The lowest modes of an elastic body by block Lanczos, with the two things it is made of: the factorised
// matrix (MUMPS) and the tall matrix of basis vectors (BLAS).
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <memory>
#include <vector>

#include "intaglio/error.h"
#include "sound/bake/fem/elastic_system.h"

namespace intaglio::sound {

// While one of these lives, OpenBLAS computes on one thread, so that factors, and with them every mode, are
// the same on any machine. The number of threads is the process's: the last object to die restores what it
// was. Another BLAS has no such setting and is left alone. Any thread.
class SingleThreadedBlas {
 public:
  SingleThreadedBlas();
  ~SingleThreadedBlas();
  SingleThreadedBlas(const SingleThreadedBlas&) = delete;
  SingleThreadedBlas& operator=(const SingleThreadedBlas&) = delete;
};

// The shifted matrix of an elastic body, factorised once and solved many times: MUMPS, with a METIS ordering
// of the nodes.
//
// Owns the factors (RAII, movable). MUMPS keeps global state, so a mutex serialises its calls: objects may
// live on any thread, but only one works at a time. Cost: 75,000 degrees of freedom take about 0.8 s, 190 MB,
// and 70 ms per solve. Source: Amestoy et al., "A fully asynchronous multifrontal solver", 2001; Karypis &
// Kumar, METIS, 1998.

enum class Definiteness { positive, indefinite };

class Factorisation {
 public:
  // Factorises K - shift * M. Fails if the matrix is singular, is not positive definite although declared so,
  // memory runs out, or `stop` is set before the numerical phase begins.
  static Result<Factorisation> factorise(const ElasticSystem& system, double shift, Definiteness definiteness,
                                         const std::atomic<bool>* stop = nullptr);

  Factorisation(Factorisation&&) noexcept;
  Factorisation& operator=(Factorisation&&) noexcept;
  ~Factorisation();

  // Overwrites the columns of `b` with the solutions of A x = b. The columns are solved together, which is
  // several times faster than one by one.
  void solve(Eigen::MatrixXd& b) const;

  // Number of negative eigenvalues of the matrix (Sylvester's law of inertia). Indefinite factorisations
  // only.
  int negative_eigenvalues() const;

 private:
  struct Instance;
  explicit Factorisation(std::unique_ptr<Instance> instance);

  std::unique_ptr<Instance> instance_;
};

// A tall, growing matrix of basis vectors, and the two products that are needed to orthogonalise against
// them.
//
// Stored in chunks, so that growing never copies. The products are computed by BLAS, which chooses its kernel
// by the processor. Cost: both products together stream the basis through memory twice.

class TallBasis {
 public:
  explicit TallBasis(Eigen::Index rows) : rows_(rows) {}

  Eigen::Index size() const { return size_; }
  void append(const Eigen::MatrixXd& columns);

  // V^T x and x - V h, of the columns from `first` on.
  Eigen::MatrixXd transposed_times(const Eigen::MatrixXd& x, Eigen::Index first = 0) const;
  void subtract(const Eigen::MatrixXd& h, Eigen::MatrixXd& x, Eigen::Index first = 0) const;
  // V y.
  Eigen::MatrixXd times(const Eigen::MatrixXd& y) const;

 private:
  template <class Visit>
  void each_chunk(Eigen::Index first, Visit visit) const;

  Eigen::Index rows_, size_ = 0;
  std::vector<Eigen::MatrixXd> chunks_;
};

// Block Lanczos for A = (K - sigma M)^-1 M: the largest eigenvalues theta of A are the eigenvalues
// lambda = 1 / theta + sigma of K u = lambda M u that are nearest above sigma.
//
// The basis is kept M-orthogonal in full: after the recurrence against the last two blocks, one pass against
// all. No restart. A block of eight finds up to eightfold eigenvalues at once and lets solves and products
// run on eight columns. Deterministic: the start block is seeded. Source: Grimes, Lewis, Simon, "A shifted
// block Lanczos algorithm for solving sparse symmetric generalized eigenproblems", 1994.

class BlockLanczos {
 public:
  static constexpr Eigen::Index block_size = 8;

  // Both must outlive the object. The basis holds at most `max_size` vectors.
  BlockLanczos(const Factorisation& shifted, const ElasticSystem& system, Eigen::Index max_size);

  Eigen::Index size() const { return basis_.size(); }
  // No further block fits, or none is left: the basis spans an invariant subspace.
  bool is_full() const { return next_.cols() == 0 || size() + block_size > max_size_; }
  // Adds one block to the basis: one solve of eight columns.
  void extend();

  // Solves the projected problem.
  void project();
  // Results of the last projection: the number of converged leading values, and the values, descending.
  Eigen::Index converged() const { return converged_; }
  double value(Eigen::Index i) const { return values_[i]; }
  // M-orthonormal vectors of the values from `first` on.
  Eigen::MatrixXd ritz_vectors(Eigen::Index first, Eigen::Index count) const;

 private:
  Eigen::MatrixXd orthonormalise();

  const Factorisation& shifted_;
  const ElasticSystem& system_;
  Eigen::Index max_size_;
  TallBasis basis_;
  Eigen::MatrixXd next_, mass_next_;  // the next block, and M times it
  Eigen::MatrixXd projected_;         // T = V^T M A V
  Eigen::MatrixXd coupling_;          // B: of the next block to the last one
  Eigen::VectorXd values_;
  Eigen::MatrixXd vectors_;
  Eigen::Index converged_ = 0;
};

}  // namespace intaglio::sound
