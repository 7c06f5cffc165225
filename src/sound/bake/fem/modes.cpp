#include "sound/bake/fem/modes.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <fmt/format.h>

#include "core/portable_math.h"
#include "sound/bake/fem/block_lanczos.h"

namespace intaglio::sound {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr int rigid_count = 6;
constexpr double accepted_residual = 1e-4;

double eigenvalue_of(double frequency) {
  return std::pow(2 * std::numbers::pi * frequency, 2);
}

double worst_residual(const ElasticSystem& system, const Modes& modes) {
  double worst = 0;
  for (Index i = 0; i < modes.shape.cols(); i += BlockLanczos::block_size) {
    const MatrixXd u = modes.shape.middleCols(i, std::min(BlockLanczos::block_size, modes.shape.cols() - i));
    const MatrixXd ku = system.stiffness_times(u), mu = system.mass_times(u);
    for (Index k = 0; k < u.cols(); ++k) {
      const double lambda = modes.angular_frequency[i + k] * modes.angular_frequency[i + k];
      worst = std::max(worst, (ku.col(k) - lambda * mu.col(k)).norm() / (lambda * mu.col(k).norm()));
    }
  }
  return worst;
}

Result<Modes> modes_at(const ElasticSystem& system, const ModeOptions& options, double shift) {
  const double lowest = eigenvalue_of(options.min_frequency), highest = eigenvalue_of(options.max_frequency);
  const double rigid_limit = -1e-6 * shift;
  auto shifted = Factorisation::of(system, shift, Definiteness::positive);
  if (!shifted) return tl::unexpected(shifted.error());

  const Index wanted = options.count + rigid_count;
  BlockLanczos lanczos(*shifted, system,
                       std::min<Index>(system.dofs(), 6 * wanted + 20 * BlockLanczos::block_size));
  const auto eigenvalue = [&](Index i) { return 1 / lanczos.value(i) + shift; };
  // The end of the group of equal frequencies that `end` cuts, or `found` if it may go on beyond.
  const auto whole_group = [&](Index end, Index found) {
    const double apart =
        2 * same_frequency;  // eigenvalues are squares: twice the relative distance of frequencies
    while (end < found && eigenvalue(end) - eigenvalue(end - 1) <= apart * eigenvalue(end)) ++end;
    return end;
  };
  const auto is_done = [&] {
    const Index found = lanczos.converged();
    Index below = 0;
    while (below < found && eigenvalue(below) < lowest) ++below;
    if (found == system.dofs()) return true;
    if (found > below && eigenvalue(found - 1) > highest * (1 + 4 * same_frequency)) return true;
    return found - below >= options.count && whole_group(below + options.count, found) < found;
  };
  Index next_check = 4 * BlockLanczos::block_size;
  do {
    if (lanczos.is_full()) {
      return fail("modal analysis", fmt::format("{} of {} modes converged", lanczos.converged(), wanted),
                  "ask for fewer modes, or use a finer mesh");
    }
    lanczos.grow();
    if (lanczos.size() < next_check && !lanczos.is_full()) continue;
    lanczos.project();
    if (options.progress) options.progress(std::min(1.0, double(lanczos.converged()) / double(wanted)));
    next_check = lanczos.size() + std::max<Index>(BlockLanczos::block_size, lanczos.size() / 12);
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
  if (end > first) end = whole_group(end, found);

  {
    // At a million degrees of freedom the factors are 4 GB; what follows does without.
    const Factorisation done = std::move(*shifted);
  }
  Modes modes;
  modes.angular_frequency.resize(end - first);
  for (Index i = first; i < end; ++i) modes.angular_frequency[i - first] = std::sqrt(eigenvalue(i));
  for (Index i = 0; i < rigid; ++i)
    modes.highest_rigid = std::max(modes.highest_rigid, std::sqrt(std::abs(eigenvalue(i))));
  modes.shape = lanczos.ritz_vectors(first, end - first);
  make_canonical(modes);
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
  // One far smaller has none in the range, but only from farther away can that be told.
  for (const double nearer : {200.0, 2000.0, 20000.0, 0.01}) {
    if (first) break;
    if (auto modes = modes_at(system, options, -eigenvalue_of(options.max_frequency / nearer))) return modes;
  }
  return first;
}

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// F^T U, F of as many fields as U has columns: row by row, so that no other matrix of U's height is made.
MatrixXd projection(const Eigen::Ref<const MatrixXd>& u) {
  MatrixXd sum = MatrixXd::Zero(u.cols(), u.cols());
  Random random(1);
  for (Index row = 0; row < u.rows(); ++row) {
    for (Index field = 0; field < u.cols(); ++field) {
      const double f = random.uniform(-1, 1);
      for (Index k = 0; k < u.cols(); ++k) sum(field, k) += f * u(row, k);
    }
  }
  return sum;
}

}  // namespace

std::vector<Index> frequency_groups(std::span<const double> angular_frequency) {
  std::vector<Index> first{0};
  for (std::size_t m = 1; m < angular_frequency.size(); ++m) {
    if (angular_frequency[m] - angular_frequency[m - 1] > same_frequency * angular_frequency[m])
      first.push_back(Index(m));
  }
  if (!angular_frequency.empty()) first.push_back(Index(angular_frequency.size()));
  return first;
}

void make_canonical(Modes& modes) {
  const std::vector<Index> first =
      frequency_groups({modes.angular_frequency.data(), std::size_t(modes.angular_frequency.size())});
  for (std::size_t g = 0; g + 1 < first.size(); ++g) {
    const Index size = first[g + 1] - first[g];
    auto shapes = modes.shape.middleCols(first[g], size);
    const MatrixXd seen = projection(shapes);
    if (size == 1) {
      if (seen(0, 0) < 0) shapes = -shapes;
      continue;
    }
    auto frequencies = modes.angular_frequency.segment(first[g], size);
    frequencies.setConstant(frequencies.mean());
    const Eigen::JacobiSVD<MatrixXd> svd(seen, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const MatrixXd turn = svd.matrixV() * svd.matrixU().transpose();
    for (Index row = 0; row < shapes.rows(); ++row) shapes.row(row) = (shapes.row(row) * turn).eval();
  }
}

}  // namespace intaglio::sound
