#include "intaglio/sound/fem/canonical_basis.h"

#include <Eigen/SVD>

#include "intaglio/core/random.h"

namespace intaglio::sound {

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
