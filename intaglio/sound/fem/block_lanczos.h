// Block Lanczos for A = (K - sigma M)^-1 M: the largest eigenvalues theta of A are those lambda = 1 / theta +
// sigma of K u = lambda M u that are nearest above sigma.
//
// The basis is kept M-orthogonal in full: after the recurrence against the last two blocks, one pass against
// all. No restart. A block of eight meets degenerate modes together, and makes every solve and product eight
// wide. Deterministic: the start block is seeded. Source: Grimes, Lewis, Simon, "A shifted block Lanczos
// algorithm for solving sparse symmetric generalized eigenproblems", 1994.
#pragma once

#include "intaglio/sound/fem/factorisation.h"
#include "intaglio/sound/fem/tall_basis.h"

namespace intaglio::sound {

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
