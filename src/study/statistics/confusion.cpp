#include "study/statistics/confusion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "study/statistics/distributions.h"

namespace intaglio::statistics {
namespace {

constexpr const char* matrix_name = "confusion matrix";

// Entropy in bits of counts, and its correction by Miller and Madow.
struct Entropy {
  double bits = 0, correction = 0;
};

Entropy entropy(const std::vector<double>& counts, double n) {
  Entropy out;
  double occupied = 0;
  for (const double count : counts) {
    if (count == 0) continue;
    out.bits -= count / n * std::log2(count / n);
    ++occupied;
  }
  out.correction = (occupied - 1) / (2 * n * std::log(2.0));
  return out;
}

// P(at least `within`) of the sum of binomial counts: errors of a row, and the chance that one stays within.
double upper_tail(const std::vector<std::pair<double, double>>& rows, std::size_t within) {
  std::vector<double> ways = {1};
  for (const auto& [errors, chance] : rows)
    for (double k = 0; k < errors; ++k) {
      ways.push_back(0);
      for (std::size_t sum = ways.size(); sum-- > 0;)
        ways[sum] = ways[sum] * (1 - chance) + (sum > 0 ? ways[sum - 1] * chance : 0);
    }
  double tail = 0;
  for (std::size_t sum = ways.size(); sum-- > within;) tail += ways[sum];
  return std::min(1.0, tail);
}

}  // namespace

double ConfusionMatrix::row_sum(std::size_t shown) const {
  const auto row = cells.begin() + std::ptrdiff_t(shown * items);
  return std::accumulate(row, row + std::ptrdiff_t(items), 0.0);
}

double ConfusionMatrix::sum() const {
  return std::accumulate(cells.begin(), cells.end(), 0.0);
}

bool ConfusionMatrix::has_counts() const {
  return std::all_of(cells.begin(), cells.end(), [](double cell) { return std::floor(cell) == cell; });
}

Result<ConfusionMatrix> confusion_matrix(std::size_t items, std::vector<double> cells) {
  if (items < 2) return fail(matrix_name, fmt::format("there are {} items", items), "give at least two");
  if (cells.size() != items * items)
    return fail(matrix_name, fmt::format("{} items have {} cells", items, cells.size()),
                fmt::format("give {}", items * items));
  for (const double cell : cells)
    if (!(cell >= 0) || std::isinf(cell))
      return fail(matrix_name, fmt::format("a cell is {}", cell), "a cell is a count or a percentage");
  return ConfusionMatrix{items, std::move(cells)};
}

Result<ConfusionMatrix> confusion_matrix(std::size_t items, std::span<const int> shown,
                                         std::span<const int> answered) {
  if (shown.size() != answered.size())
    return fail(matrix_name, fmt::format("{} trials have {} answers", shown.size(), answered.size()),
                "give as many, and -1 for a missing answer");
  std::vector<double> cells(items * items, 0);
  for (std::size_t k = 0; k < shown.size(); ++k) {
    if (shown[k] < 0 || shown[k] >= int(items) || answered[k] < -1 || answered[k] >= int(items))
      return fail(matrix_name,
                  fmt::format("trial {} shows {} and has the answer {}", k + 1, shown[k], answered[k]),
                  fmt::format("items have numbers from 0 to {}", int(items) - 1));
    if (answered[k] >= 0) ++cells[std::size_t(shown[k]) * items + std::size_t(answered[k])];
  }
  return confusion_matrix(items, std::move(cells));
}

double rate_correct(const ConfusionMatrix& matrix) {
  double right = 0;
  for (std::size_t k = 0; k < matrix.items; ++k) right += matrix.at(k, k);
  const double all = matrix.sum();
  return all > 0 ? right / all : undefined;
}

double mean_row_rate(const ConfusionMatrix& matrix) {
  double rates = 0, rows = 0;
  for (std::size_t k = 0; k < matrix.items; ++k) {
    const double all = matrix.row_sum(k);
    if (!(all > 0)) continue;
    rates += matrix.at(k, k) / all;
    ++rows;
  }
  return rows > 0 ? rates / rows : undefined;
}

Result<Information> information(const ConfusionMatrix& matrix) {
  if (!matrix.has_counts())
    return fail("transmitted information", "the cells are no counts",
                "give the number of trials of each cell: its bias depends on it");
  const double n = matrix.sum();
  if (n == 0) return Information{undefined, undefined, "there are no trials"};
  std::vector<double> shown(matrix.items, 0), answered(matrix.items, 0);
  for (std::size_t i = 0; i < matrix.items; ++i)
    for (std::size_t j = 0; j < matrix.items; ++j) {
      shown[i] += matrix.at(i, j);
      answered[j] += matrix.at(i, j);
    }
  const Entropy a = entropy(shown, n), b = entropy(answered, n), both = entropy(matrix.cells, n);
  Information out;
  out.bits = a.bits + b.bits - both.bits;
  out.miller_madow = out.bits + a.correction + b.correction - both.correction;
  if (out.miller_madow < 0) out.note = "the correction exceeds the information: these trials show none";
  return out;
}

Result<FamilyErrors> family_errors(const ConfusionMatrix& matrix, std::span<const int> families) {
  constexpr const char* what = "errors within families";
  if (families.size() != matrix.items)
    return fail(what, fmt::format("{} items have {} families", matrix.items, families.size()),
                "give each item one");
  FamilyErrors out;
  double expected = 0;
  std::vector<std::pair<double, double>> rows;
  for (std::size_t i = 0; i < matrix.items; ++i) {
    const double size = double(std::count(families.begin(), families.end(), families[i]));
    const double chance = (size - 1) / double(matrix.items - 1);
    double errors = 0;
    for (std::size_t j = 0; j < matrix.items; ++j) {
      if (i == j) continue;
      errors += matrix.at(i, j);
      if (families[i] == families[j]) out.within += matrix.at(i, j);
    }
    out.errors += errors;
    expected += errors * chance;
    out.chance_equal += chance / double(matrix.items);
    rows.emplace_back(errors, chance);
  }
  if (out.errors == 0) {
    out.share = out.chance = out.p = undefined;
    out.note = "there are no errors";
    return out;
  }
  out.share = out.within / out.errors;
  out.chance = expected / out.errors;
  const bool can_test = matrix.has_counts() && out.errors <= 10'000;
  out.p = can_test ? upper_tail(rows, std::size_t(out.within)) : undefined;
  if (!can_test) out.note = "a test needs counts of trials, at most 10000 errors";
  return out;
}

}  // namespace intaglio::statistics
