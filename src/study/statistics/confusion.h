// Confusion matrices: rates, transmitted information, and errors that stay within a family.
//
// A row is what was shown, a column what was answered; counts, or percentages as a publication prints them
// (then what needs counts is refused or not a number).
//
//   information   Σ p_ij log2(p_ij / (p_i p_j)): biased upwards, by few trials
//   Miller-Madow  H(row) + H(column) - H(both), to each of which (m - 1) / (2 n ln 2) is added, m of its
//                 cells not being empty
//   within        the share of errors whose answer is of the shown item's family; by chance an error falls on
//                 each other item alike: (size of the family - 1) / (items - 1) of a row's errors
//   p             P(as many errors within or more), of a sum of binomial counts, one a row; for
//                 at most 10000 errors
//
// Sources: Shannon 1948; Miller, "Note on the bias of information estimates", 1955. Errors say what is
// wrong: a wrong number of cells, a negative or infinite one, an answer that is no item. No trials, no
// errors: not a number and a note. Any thread.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "intaglio/error.h"

namespace intaglio::statistics {

struct ConfusionMatrix {
  std::size_t items = 0;
  std::vector<double> cells;  // items × items, by rows

  double at(std::size_t shown, std::size_t answered) const { return cells[shown * items + answered]; }
  double row_sum(std::size_t shown) const;
  double sum() const;
  bool has_counts() const;  // whole numbers only
};

Result<ConfusionMatrix> confusion_matrix(std::size_t items, std::vector<double> cells);
// From trials: item numbers from 0; an answer of -1 is missing and left out.
Result<ConfusionMatrix> confusion_matrix(std::size_t items, std::span<const int> shown,
                                         std::span<const int> answered);

// The diagonal's share of all, and the mean of the rows' (rows without trials left out).
double rate_correct(const ConfusionMatrix& matrix);
double mean_row_rate(const ConfusionMatrix& matrix);

struct Information {
  double bits = 0, miller_madow = 0;
  std::string note;
};

// The error: cells that are no counts.
Result<Information> information(const ConfusionMatrix& matrix);

struct FamilyErrors {
  double errors = 0, within = 0;  // counts, or sums of the cells
  double share = 0;               // within / errors
  double chance = 0;              // expected share, by the rows' errors
  double chance_equal = 0;        // expected share where each row has as many errors
  double p = 0;                   // not a number for cells that are no counts
  std::string note;
};

// `families` has a number for each item.
Result<FamilyErrors> family_errors(const ConfusionMatrix& matrix, std::span<const int> families);

}  // namespace intaglio::statistics
