// A growing set of columns, each as long as a body has degrees of freedom, and the two products that
// orthogonalising against them takes.
//
// Kept in chunks, so that growing never copies; the products are BLAS's, which chooses its kernel by the
// processor. Cost: both products together stream the basis through memory twice.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace intaglio::sound {

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

}  // namespace intaglio::sound
