#include "intaglio/sound/fem/modes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "intaglio/core/random.h"
#include "intaglio/sound/fem/factorisation.h"

namespace intaglio::sound {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index block_size = 8;
constexpr int rigid_count = 6;
constexpr double tolerance = 1e-11;  // of a Ritz value, relative
constexpr double accepted_residual = 1e-4;

double eigenvalue_of(double frequency) {
  return std::pow(2 * std::numbers::pi * frequency, 2);
}

// The growing Krylov basis V, M-orthonormal, and the projected operator T = V^T M A V, where A = (K - sigma
// M)^-1 M.
class BlockLanczos {
 public:
  BlockLanczos(const Factorisation& shifted, const SparseMatrix& mass, Index most)
      : shifted_(shifted), mass_(mass), basis_(mass.cols(), most), projected_(MatrixXd::Zero(most, most)) {
    Random random(1);
    next_ = MatrixXd::NullaryExpr(mass.cols(), block_size, [&] { return random.uniform(-1, 1); });
    // One application of A leaves little of the stiff components, which no wanted mode has.
    apply(next_);
    orthonormalise(next_);
  }

  Index size() const { return size_; }
  bool is_full() const { return next_.cols() == 0 || size_ + block_size > basis_.cols(); }

  void grow() {
    const Index first = size_, width = next_.cols();
    basis_.middleCols(first, width) = next_;
    size_ += width;
    apply(next_);
    const auto v = basis_.leftCols(size_);
    const MatrixXd h = v.transpose() * (mass_ * next_);
    next_.noalias() -= v * h;
    projected_.block(0, first, size_, width) = h;
    projected_.block(first, 0, width, first) = h.topRows(first).transpose();
    // What rounding left of the basis grows like a weed; the second pass pulls it out.
    const MatrixXd again = v.transpose() * (mass_ * next_);
    next_.noalias() -= v * again;
    coupling_ = orthonormalise(next_);
  }

  // Solves the projected problem: values descending, vectors in the basis, and how many of the first have
  // converged.
  void project() {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(projected_.topLeftCorner(size_, size_));
    values_ = solver.eigenvalues().reverse();
    vectors_ = solver.eigenvectors().rowwise().reverse();
    const Index width = coupling_.cols();
    converged_ = 0;
    while (converged_ < size_ &&
           (coupling_ * vectors_.col(converged_).tail(width)).norm() <= tolerance * values_[converged_]) {
      ++converged_;
    }
  }
  Index converged() const { return converged_; }
  double value(Index i) const { return values_[i]; }
  MatrixXd ritz_vectors(Index first, Index count) const {
    return basis_.leftCols(size_) * vectors_.middleCols(first, count);
  }

 private:
  void apply(MatrixXd& block) const {
    block = mass_ * block;
    shifted_.solve(block);
  }

  // Makes the columns of w M-orthonormal, dropping those that depend on the others; returns R with w_before =
  // w R.
  MatrixXd orthonormalise(MatrixXd& w) const {
    MatrixXd r = MatrixXd::Identity(w.cols(), w.cols());
    for (int pass = 0; pass < 2; ++pass) {
      const MatrixXd gram = w.transpose() * (mass_ * w);
      const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(gram);
      const VectorXd& d = solver.eigenvalues();
      Index kept = 0;
      while (kept < d.size() && d[d.size() - 1 - kept] > 1e-24 * d[d.size() - 1] &&
             d[d.size() - 1 - kept] > 0)
        ++kept;
      const MatrixXd q = solver.eigenvectors().rightCols(kept);
      const VectorXd root = d.tail(kept).cwiseSqrt();
      r = root.asDiagonal() * q.transpose() * r;
      w = w * q * root.cwiseInverse().asDiagonal();
    }
    return r;
  }

  const Factorisation& shifted_;
  const SparseMatrix& mass_;
  MatrixXd basis_, projected_, next_, coupling_;
  Index size_ = 0;
  VectorXd values_;
  MatrixXd vectors_;
  Index converged_ = 0;
};

void fix_signs(MatrixXd& shapes) {
  for (auto column : shapes.colwise()) {
    const double large = 0.5 * column.cwiseAbs().maxCoeff();
    const auto first =
        std::find_if(column.begin(), column.end(), [&](double x) { return std::abs(x) > large; });
    if (first != column.end() && *first < 0) column = -column;
  }
}

double worst_residual(const ElasticSystem& system, const Modes& modes) {
  const MatrixXd ku = system.stiffness * modes.shape;
  const MatrixXd mu = system.mass * modes.shape;
  double worst = 0;
  for (Index i = 0; i < modes.shape.cols(); ++i) {
    const double lambda = modes.angular_frequency[i] * modes.angular_frequency[i];
    worst = std::max(worst, (ku.col(i) - lambda * mu.col(i)).norm() / (lambda * mu.col(i).norm()));
  }
  return worst;
}

Result<Modes> modes_at(const ElasticSystem& system, const ModeOptions& options, double shift) {
  const double lowest = eigenvalue_of(options.min_frequency), highest = eigenvalue_of(options.max_frequency);
  const double rigid_limit = -1e-6 * shift;
  auto shifted = Factorisation::of(system.stiffness - shift * system.mass, Definiteness::positive);
  if (!shifted) return tl::unexpected(shifted.error());

  const Index wanted = options.count + rigid_count;
  BlockLanczos lanczos(*shifted, system.mass,
                       std::min<Index>(system.mass.cols(), 6 * wanted + 20 * block_size));
  const auto eigenvalue = [&](Index i) { return 1 / lanczos.value(i) + shift; };
  const auto is_done = [&] {
    const Index found = lanczos.converged();
    Index below = 0;
    while (below < found && eigenvalue(below) < lowest) ++below;
    return found - below >= options.count || (found > below && eigenvalue(found - 1) > highest);
  };
  Index next_check = 4 * block_size;
  do {
    if (lanczos.is_full()) {
      return fail("modal analysis", fmt::format("{} of {} modes converged", lanczos.converged(), wanted),
                  "ask for fewer modes, or use a finer mesh");
    }
    lanczos.grow();
    if (lanczos.size() < next_check && !lanczos.is_full()) continue;
    lanczos.project();
    if (options.progress) options.progress(std::min(1.0, double(lanczos.converged()) / double(wanted)));
    next_check = lanczos.size() + std::max<Index>(block_size, lanczos.size() / 6);
  } while (!is_done());

  const Index found = lanczos.converged();
  Index rigid = 0;
  while (rigid < found && eigenvalue(rigid) < rigid_limit) ++rigid;
  if (rigid != rigid_count) {
    return fail("modal analysis", fmt::format("the free body has {} rigid modes instead of six", rigid),
                "every part of the mesh must be connected to the rest by whole faces");
  }
  Index first = rigid, end = rigid;
  while (first < found && eigenvalue(first) < lowest) ++first;
  for (end = first; end < found && end - first < options.count && eigenvalue(end) <= highest;) ++end;

  Modes modes;
  modes.angular_frequency.resize(end - first);
  for (Index i = first; i < end; ++i) modes.angular_frequency[i - first] = std::sqrt(eigenvalue(i));
  modes.shape = lanczos.ritz_vectors(first, end - first);
  fix_signs(modes.shape);
  modes.residual = worst_residual(system, modes);
  if (modes.residual > accepted_residual) {
    return fail("modal analysis", fmt::format("a mode has residual {:.1e}", modes.residual),
                "use a finer mesh");
  }
  return modes;
}

}  // namespace

Result<Modes> free_modes(const ElasticSystem& system, const ModeOptions& options) {
  // A twentieth of the highest frequency: far from the rigid modes' zero, yet near it among the wanted ones.
  // A large or thin body has its modes so much lower that they look alike from there, or rigid: then come
  // nearer.
  Result<Modes> first = modes_at(system, options, -eigenvalue_of(options.max_frequency / 20));
  for (const double nearer : {200.0, 2000.0, 20000.0}) {
    if (first) break;
    if (auto modes = modes_at(system, options, -eigenvalue_of(options.max_frequency / nearer))) return modes;
  }
  return first;
}

}  // namespace intaglio::sound
