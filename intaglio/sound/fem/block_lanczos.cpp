#include "intaglio/sound/fem/block_lanczos.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "intaglio/core/random.h"

namespace intaglio::sound {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double tolerance = 1e-8;  // of a Ritz value, relative; the error of the value itself is its square

}  // namespace

BlockLanczos::BlockLanczos(const Factorisation& shifted, const ElasticSystem& system, Index most)
    : shifted_(shifted), system_(system), most_(most), basis_(system.dofs()) {
  Random random(1);
  next_ = MatrixXd::NullaryExpr(system.dofs(), block_size, [&] { return random.uniform(-1, 1); });
  // One application of A leaves little of the stiff components, which no wanted mode has.
  next_ = system_.mass_times(next_);
  shifted_.solve(next_);
  orthonormalise();
}

void BlockLanczos::grow() {
  const Index first = size(), width = next_.cols();
  basis_.append(next_);
  next_ = mass_next_;
  shifted_.solve(next_);
  projected_.conservativeResizeLike(MatrixXd::Zero(size(), size()));
  const auto take_out = [&](Index from) {
    const MatrixXd h = basis_.transposed_times(system_.mass_times(next_), from);
    basis_.subtract(h, next_, from);
    projected_.block(from, first, h.rows(), width) += h;
  };
  // In exact arithmetic only the last two blocks matter; the full pass pulls out what rounding left of the
  // others, which would grow like a weed.
  take_out(std::max<Index>(0, first - block_size));
  take_out(0);
  projected_.block(first, 0, width, first) = projected_.block(0, first, first, width).transpose();
  coupling_ = orthonormalise();
}

void BlockLanczos::project() {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(projected_);
  values_ = solver.eigenvalues().reverse();
  vectors_ = solver.eigenvectors().rowwise().reverse();
  const Index width = coupling_.cols();
  converged_ = 0;
  while (converged_ < size() &&
         (coupling_ * vectors_.col(converged_).tail(width)).norm() <= tolerance * values_[converged_]) {
    ++converged_;
  }
}

MatrixXd BlockLanczos::ritz_vectors(Index first, Index count) const {
  return basis_.times(vectors_.middleCols(first, count));
}

// Makes the columns of the next block M-orthonormal, dropping those that depend on the others; returns R with
// before = after R.
MatrixXd BlockLanczos::orthonormalise() {
  mass_next_ = system_.mass_times(next_);
  MatrixXd r = MatrixXd::Identity(next_.cols(), next_.cols());
  for (int pass = 0; pass < 2; ++pass) {
    const MatrixXd gram = next_.transpose() * mass_next_;
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(gram);
    const Eigen::VectorXd& d = solver.eigenvalues();
    Index kept = 0;
    while (kept < d.size() && d[d.size() - 1 - kept] > 1e-24 * d[d.size() - 1] && d[d.size() - 1 - kept] > 0)
      ++kept;
    const MatrixXd q = solver.eigenvectors().rightCols(kept);
    const Eigen::VectorXd root = d.tail(kept).cwiseSqrt();
    r = root.asDiagonal() * q.transpose() * r;
    const MatrixXd turn = q * root.cwiseInverse().asDiagonal();
    next_ = next_ * turn;
    mass_next_ = mass_next_ * turn;
  }
  return r;
}

}  // namespace intaglio::sound
