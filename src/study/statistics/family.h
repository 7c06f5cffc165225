// Families of hypotheses: p adjusted by Holm's method, so that a family's chance of any false rejection is
// alpha.
//
// Sorted p are multiplied by m, m - 1, ... 1, made to rise, and limited to 1. Needs no independence. A p
// that is not a number (a test without result) stays so and is not counted in m. The error: a p outside [0,
// 1]. Source: Holm, "A simple sequentially rejective multiple test procedure", 1979. Any thread.
#pragma once

#include <span>
#include <vector>

#include "intaglio/error.h"

namespace intaglio::statistics {

// In the order of the p.
Result<std::vector<double>> holm(std::span<const double> p);

}  // namespace intaglio::statistics
