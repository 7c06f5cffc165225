// The matrix of an elastic body, shifted, factorised once and solved many times: MUMPS, with a METIS ordering
// of the nodes.
//
// Owns the factors (RAII, movable). MUMPS keeps global state, so its calls are serialised by a mutex: objects
// may live on any thread, but only one works at a time. BLAS is set to one thread for the whole process, so
// that the factors, and with them every mode, are the same on any machine. Cost: 75,000 degrees of freedom
// take about 0.8 s, 190 MB, and 70 ms a solve. Source: Amestoy et al., "A fully asynchronous multifrontal
// solver", 2001; Karypis & Kumar, METIS, 1998.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "intaglio/error.h"
#include "sound/bake/fem/elastic_system.h"

namespace intaglio::sound {

enum class Definiteness { positive, indefinite };

class Factorisation {
 public:
  // Factorises K - shift * M. Fails when it is singular, or, said to be positive definite, is not, or when
  // memory runs out.
  static Result<Factorisation> of(const ElasticSystem& system, double shift, Definiteness definiteness);

  Factorisation(Factorisation&&) noexcept;
  Factorisation& operator=(Factorisation&&) noexcept;
  ~Factorisation();

  // Overwrites the columns of `b` with the solutions of A x = b. The columns are solved together, which is
  // several times faster than one by one.
  void solve(Eigen::MatrixXd& b) const;

  // How many eigenvalues of the matrix are negative (Sylvester's law of inertia). Indefinite factorisations
  // only.
  int negative_eigenvalues() const;

 private:
  struct Instance;
  explicit Factorisation(std::unique_ptr<Instance> instance);

  std::unique_ptr<Instance> instance_;
};

// A growing set of columns, each as long as a body has degrees of freedom, and the two products that
// orthogonalising against them takes.
//
// Kept in chunks, so that growing never copies; the products are BLAS's, which chooses its kernel by the
// processor. Cost: both products together stream the basis through memory twice.

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

// Block Lanczos for A = (K - sigma M)^-1 M: the largest eigenvalues theta of A are those lambda = 1 / theta +
// sigma of K u = lambda M u that are nearest above sigma.
//
// The basis is kept M-orthogonal in full: after the recurrence against the last two blocks, one pass against
// all. No restart. A block of eight meets degenerate modes together, and makes every solve and product eight
// wide. Deterministic: the start block is seeded. Source: Grimes, Lewis, Simon, "A shifted block Lanczos
// algorithm for solving sparse symmetric generalized eigenproblems", 1994.

class BlockLanczos {
 public:
  static constexpr Eigen::Index block_size = 8;

  // Both must outlive the growing. At most `most` vectors.
  BlockLanczos(const Factorisation& shifted, const ElasticSystem& system, Eigen::Index most);

  Eigen::Index size() const { return basis_.size(); }
  bool is_full() const { return next_.cols() == 0 || size() + block_size > most_; }
  void grow();

  // Solves the projected problem.
  void project();
  // Of the last projection: how many of the largest values have converged, and they, descending.
  Eigen::Index converged() const { return converged_; }
  double value(Eigen::Index i) const { return values_[i]; }
  // M-orthonormal vectors of the values from `first` on.
  Eigen::MatrixXd ritz_vectors(Eigen::Index first, Eigen::Index count) const;

 private:
  Eigen::MatrixXd orthonormalise();

  const Factorisation& shifted_;
  const ElasticSystem& system_;
  Eigen::Index most_;
  TallBasis basis_;
  Eigen::MatrixXd next_, mass_next_;  // the block to come, and M times it
  Eigen::MatrixXd projected_;         // T = V^T M A V
  Eigen::MatrixXd coupling_;          // of the block to come with the last one
  Eigen::VectorXd values_;
  Eigen::MatrixXd vectors_;
  Eigen::Index converged_ = 0;
};

}  // namespace intaglio::sound
