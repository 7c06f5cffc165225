#include "sound/bake/fem/modes.h"

#include <fmt/format.h>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

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

// The eigenvalues of K u = lambda M u that an iteration has found.
struct Spectrum {
  const BlockLanczos& lanczos;
  double shift;

  Index found() const { return lanczos.converged(); }
  double operator[](Index i) const { return 1 / lanczos.value(i) + shift; }
  Index count_below(double eigenvalue) const {
    Index count = 0;
    while (count < found() && (*this)[count] < eigenvalue) ++count;
    return count;
  }
  // Moves `end` past modes of equal frequency; returns found() if the group may be incomplete. Eigenvalues
  // are squares: their relative distance is twice that of frequencies.
  Index end_of_group(Index end) const {
    while (end < found() && (*this)[end] - (*this)[end - 1] <= 2 * frequency_tolerance * (*this)[end]) ++end;
    return end;
  }
};

// Extends the basis until it holds the wanted modes, and one beyond, or all that there are.
Result<void> iterate(BlockLanczos& lanczos, const Spectrum& spectrum, const ModeOptions& options,
                     Index all_modes) {
  const double lowest = eigenvalue_of(options.min_frequency), highest = eigenvalue_of(options.max_frequency);
  const Index wanted = options.count + rigid_count;
  const auto is_done = [&] {
    const Index found = spectrum.found(), below = spectrum.count_below(lowest);
    if (found == all_modes) return true;
    if (found > below && spectrum[found - 1] > highest * (1 + 4 * frequency_tolerance)) return true;
    return found - below >= options.count && spectrum.end_of_group(below + options.count) < found;
  };
  Index next_check = 4 * BlockLanczos::block_size;
  do {
    if (lanczos.is_full()) {
      return fail("modal analysis", fmt::format("{} of {} modes converged", lanczos.converged(), wanted),
                  "ask for fewer modes, or use a finer mesh");
    }
    if (stop_requested(options.stop)) return bake_stopped();
    lanczos.extend();
    if (lanczos.size() < next_check && !lanczos.is_full()) continue;
    lanczos.project();
    if (options.progress) options.progress(std::min(1.0, double(lanczos.converged()) / double(wanted)));
    next_check = lanczos.size() + std::max<Index>(BlockLanczos::block_size, lanczos.size() / 12);
  } while (!is_done());
  return {};
}

Result<Modes> solve_with_shift(const ElasticSystem& system, const ModeOptions& options, double shift) {
  auto factorised = Factorisation::factorise(system, shift, Definiteness::positive, options.stop);
  if (!factorised) return tl::unexpected(factorised.error());
  std::optional<Factorisation> shifted = std::move(*factorised);
  const Index wanted = options.count + rigid_count;
  BlockLanczos lanczos(*shifted, system,
                       std::min<Index>(system.dofs(), 6 * wanted + 20 * BlockLanczos::block_size));
  const Spectrum spectrum{lanczos, shift};
  if (auto done = iterate(lanczos, spectrum, options, system.dofs()); !done)
    return tl::unexpected(done.error());

  const Index rigid = spectrum.count_below(-1e-6 * shift);
  if (rigid != rigid_count) {
    return fail("modal analysis", fmt::format("expected six rigid modes, found {}", rigid),
                "every part of the mesh must be connected to the rest by whole faces");
  }
  const double highest = eigenvalue_of(options.max_frequency);
  const Index first = std::max(rigid, spectrum.count_below(eigenvalue_of(options.min_frequency)));
  Index end = first;
  while (end < spectrum.found() && end - first < options.count && spectrum[end] <= highest) ++end;
  if (end > first) end = spectrum.end_of_group(end);

  // At a million degrees of freedom the factors take 4 GB, and the rest does not need them.
  shifted.reset();
  Modes modes;
  modes.angular_frequency.resize(end - first);
  for (Index i = first; i < end; ++i) modes.angular_frequency[i - first] = std::sqrt(spectrum[i]);
  for (Index i = 0; i < rigid; ++i)
    modes.highest_rigid = std::max(modes.highest_rigid, std::sqrt(std::abs(spectrum[i])));
  modes.shape = lanczos.ritz_vectors(first, end - first);
  make_canonical(modes);
  modes.residual = worst_residual(system, modes);
  if (modes.residual > accepted_residual) {
    return fail("modal analysis", fmt::format("a mode has residual {:.1e}", modes.residual),
                "use a finer mesh");
  }
  return modes;
}

// F^T U, with as many fields F as U has columns, row by row to avoid another matrix as tall as U.
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

Result<Modes> free_modes(const ElasticSystem& system, const ModeOptions& options) {
  const SingleThreadedBlas single;
  // The shift -(2 pi f / 20)^2 for the highest frequency f is far from the rigid modes' zero, yet near the
  // lowest wanted ones. If all modes lie far below it (a large or thin body), they cannot be separated from
  // each other or from rigid motion: retry nearer to zero. A much smaller body has no mode in range, which a
  // shift a hundred times above f proves.
  Result<Modes> first = solve_with_shift(system, options, -eigenvalue_of(options.max_frequency / 20));
  for (const double divisor : {200.0, 2000.0, 20000.0, 0.01}) {
    if (first || stop_requested(options.stop)) break;
    auto modes = solve_with_shift(system, options, -eigenvalue_of(options.max_frequency / divisor));
    if (modes) return modes;
  }
  return first;
}

std::vector<Index> frequency_groups(std::span<const double> angular_frequency) {
  std::vector<Index> first{0};
  for (std::size_t m = 1; m < angular_frequency.size(); ++m) {
    if (angular_frequency[m] - angular_frequency[m - 1] > frequency_tolerance * angular_frequency[m])
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
    const MatrixXd projected = projection(shapes);
    if (size == 1) {
      if (projected(0, 0) < 0) shapes = -shapes;
      continue;
    }
    auto frequencies = modes.angular_frequency.segment(first[g], size);
    frequencies.setConstant(frequencies.mean());
    const Eigen::JacobiSVD<MatrixXd> svd(projected, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const MatrixXd rotation = svd.matrixV() * svd.matrixU().transpose();
    for (Index row = 0; row < shapes.rows(); ++row) shapes.row(row) = (shapes.row(row) * rotation).eval();
  }
}

}  // namespace intaglio::sound
