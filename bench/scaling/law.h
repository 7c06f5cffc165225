// How a cost grows with a size: what was measured, the power law fitted to it, and where it meets real
// time.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "intaglio/error.h"

namespace intaglio::bench {

struct Law {
  std::string axis, sense, unit;  // "bodies", "contact", "us a step at 60 Hz"
  std::vector<double> sizes, costs;
  double limit = 0;        // real time, in the unit of the costs; 0: none
  std::string limit_name;  // "one step of 1/60 s"
};

struct Fit {
  double exponent = 0, standard_error = 0;
  double last = 0;  // exponent between the last two sizes
};

// cost = a size^b by least squares of the logarithms, and the standard error of b from the residuals.
Fit fit(const Law& law);

// The size at which the cost meets the limit, between two that were measured. Infinity where the largest is
// still within it (nothing is extrapolated), 0 where the smallest is not.
double holds_until(const Law& law);

struct Effort {
  bool quick = false;
  bool large = false;  // also what takes minutes: 8192 x 8192 texels
};

// Median of `rounds` calls of measure(k) for every k, in turn.
std::vector<double> interleaved(std::size_t count, int rounds,
                                const std::function<double(std::size_t)>& measure);

// One function an axis.
Result<std::vector<Law>> scale_texture(const Effort& effort);
Result<std::vector<Law>> scale_bodies(const Effort& effort);
Result<std::vector<Law>> scale_modes(const Effort& effort);
Result<std::vector<Law>> scale_servo_rate(const Effort& effort);
Result<std::vector<Law>> scale_surfaces(const Effort& effort);

}  // namespace intaglio::bench
