// Ranges of values, and axes that map them to drawing units.
#pragma once

#include <limits>
#include <vector>

namespace intaglio::report {

struct Range {
  double low = 0;
  double high = 1;

  double size() const { return high - low; }
  // Extended by `fraction` of its size at both ends.
  Range padded(double fraction) const { return {low - fraction * size(), high + fraction * size()}; }
};

// The finite values seen so far.
class Extent {
 public:
  void add(double value);
  // The smallest range that holds them; `fallback` when there are none; never of size 0.
  Range range(const Range& fallback = {}) const;

 private:
  double low_ = std::numeric_limits<double>::infinity(), high_ = -std::numeric_limits<double>::infinity();
};

enum class AxisScale { linear, logarithmic };

// Maps values to drawing units. `units` may run downwards (low > high), as for y.
class Axis {
 public:
  Axis(const Range& values, const Range& units, AxisScale scale = AxisScale::linear);

  double operator()(double value) const;
  const Range& values() const { return values_; }
  const Range& units() const { return units_; }
  AxisScale scale() const { return scale_; }
  // Round values inside the axis: about `count` on a linear one; 1, 2, 5 times powers of ten on a logarithmic
  // one.
  std::vector<double> ticks(int count) const;

 private:
  Range values_, units_;
  AxisScale scale_;
};

}  // namespace intaglio::report
