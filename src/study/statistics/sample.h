// Samples of numbers: which values are missing, and count, mean and deviation of the others.
//
// A not-a-number is a missing value: it is left out, and counted. An infinite value is an error. A pair
// with one value missing is left out as a whole. Any thread; linear.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "intaglio/error.h"

namespace intaglio::statistics {

struct Sample {
  std::vector<double> values;  // in their order, without the missing ones
  std::size_t missing = 0;
};

// `what` begins the message of an error: "Welch's t-test".
Result<Sample> observed(std::span<const double> values, const std::string& what);

struct Summary {
  std::size_t n = 0, missing = 0;
  double mean = 0, sd = 0;  // sd with n - 1: not a number for n < 2; exactly 0 where all values are equal
};

// The errors: no value at all, an infinite value.
Result<Summary> summary(std::span<const double> values, const std::string& what = "summary");
Summary summary_of(const Sample& sample);

// Means and deviations as a publication prints them.
inline Summary printed(double mean, double sd, std::size_t n) {
  return {n, 0, mean, sd};
}

struct Pairs {
  std::vector<double> first, second, differences;  // first - second
  std::size_t missing = 0;                         // pairs
};

// The errors: lengths that differ, an infinite value, no complete pair.
Result<Pairs> complete_pairs(std::span<const double> first, std::span<const double> second,
                             const std::string& what);

// Pearson's correlation; not a number for fewer than two pairs or no variance.
double correlation(std::span<const double> first, std::span<const double> second);

}  // namespace intaglio::statistics
