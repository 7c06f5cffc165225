// How evenly participants 1 to n meet materials, conditions and places: counted in their plans, not promised.
//
// A pair of variables is balanced when every combination occurs as often as the totals of both imply (the
// counts are independent). Squares give that at multiples of their period only. Cost: n plans.
#pragma once

#include <string>
#include <vector>

#include "intaglio/error.h"
#include "study/design/design.h"

namespace intaglio::study {

struct PairBalance {
  std::string block, rows, columns;  // "identify", "material", "place"
  int least = 0, most = 0;           // of the counts of combinations
  double largest_deviation = 0;      // of a count from what the totals imply
  bool is_exact = false;
  int exact_from = 0;  // the fewest participants, of those looked at, that make it exact; 0: none
};

struct Balance {
  int participants = 0;
  int period = 1;     // at its multiples all squares are whole
  int looked_at = 0;  // the largest number of participants that was counted
  std::vector<PairBalance> pairs;
};

// `participants` from 1 to most_participants.
Result<Balance> balance(const Design& design, int participants);

// The least common multiple of the periods of all blocks' orders, materials' orders and splits.
int period_of(const Design& design);

}  // namespace intaglio::study
