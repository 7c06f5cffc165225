// Orders of trials: squares that balance them over participants, and shuffles within constraints.
//
// Randomness is core's generator, whose streams are named: the same seed, purpose and number give the same
// order on every machine, and another purpose an unrelated one. Pure functions, any thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/portable_math.h"
#include "intaglio/error.h"
#include "study/design/design.h"

namespace intaglio::study {

// The stream of a purpose ("main/materials") and number (a group of participants).
Random random_stream(std::uint64_t seed, const std::string& purpose, int number);

// Uniform among 0 to n - 1, n >= 1.
int random_below(Random& random, int n);
// 0 to n - 1 in random order, each order as likely.
std::vector<int> shuffled(int n, Random& random);

// Row `row`, from 0, of a square of n symbols. Latin (n rows): every symbol once in each place. Williams (n
// rows if n is even, 2n if not): also, over all rows, every symbol follows every other equally often.
// Source: Williams, Experimental designs balanced for the estimation of residual effects, 1949.
std::vector<int> latin_row(int n, int row);
std::vector<int> williams_row(int n, int row);

// The number of participants that balance an order of n things: 1 where it is fixed or random.
int period_of(Order order, int n);

// The order of n things for a participant, from 1. Each group of period_of() participants shares a square
// with symbols (of a Latin one also places) and rows in random order, and each of them has a row of its own.
std::vector<int> order_of(Order order, int n, int participant, std::uint64_t seed,
                          const std::string& purpose);

// A random order of trials with these conditions and materials (numbers) that keeps the constraints: drawn
// until one does, and after 1000 draws searched. Error: none was found within 20,000 steps.
Result<std::vector<int>> constrained_shuffle(const std::vector<int>& conditions,
                                             const std::vector<int>& materials,
                                             const Constraints& constraints, Random& random);

}  // namespace intaglio::study
