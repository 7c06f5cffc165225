#include "intaglio/sound/fem/tall_basis.h"

#include <algorithm>
#include <cassert>

// BLAS as Fortran has it: c = alpha op(a) op(b) + beta c.
extern "C" void dgemm_(const char* op_a, const char* op_b, const int* m, const int* n, const int* k,
                       const double* alpha, const double* a, const int* lda, const double* b, const int* ldb,
                       const double* beta, double* c, const int* ldc);

namespace intaglio::sound {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr Index chunk_columns = 64;

}  // namespace

void TallBasis::append(const MatrixXd& columns) {
  assert(columns.rows() == rows_);
  for (Index k = 0; k < columns.cols(); ++k, ++size_) {
    if (size_ % chunk_columns == 0) chunks_.emplace_back(rows_, chunk_columns);
    chunks_.back().col(size_ % chunk_columns) = columns.col(k);
  }
}

// Visits, chunk by chunk, the first of the columns, how many, and their place after `first`.
template <class Visit>
void TallBasis::each_chunk(Index first, Visit visit) const {
  for (Index at = first; at < size_;) {
    const Index in_chunk = at % chunk_columns;
    const Index count = std::min(chunk_columns - in_chunk, size_ - at);
    visit(chunks_[std::size_t(at / chunk_columns)].col(in_chunk).data(), static_cast<int>(count), at - first);
    at += count;
  }
}

MatrixXd TallBasis::transposed_times(const MatrixXd& x, Index first) const {
  MatrixXd result(size_ - first, x.cols());
  if (x.cols() == 0) return result;
  const auto n = static_cast<int>(rows_), width = static_cast<int>(x.cols()),
             height = static_cast<int>(result.rows());
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
  const auto n = static_cast<int>(rows_), width = static_cast<int>(x.cols()),
             height = static_cast<int>(h.rows());
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

}  // namespace intaglio::sound
