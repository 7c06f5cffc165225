// A curve of any length as it is drawn: the least and the greatest sample of each unit of x, so that no peak
// is lost. Samples are added one by one; memory depends on the width of the axis only.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "report/axis.h"

namespace intaglio::report {

class DrawnCurve {
 public:
  // The extrema of one unit of x, in drawing units, in order of time.
  struct Column {
    double first_x = 0, first_value = 0, second_x = 0, second_value = 0;
  };

  // Sample k is at start + k * step on the axis.
  DrawnCurve(const Axis& x, double start, double step) : x_(x), start_(start), step_(step) {}

  void add(double value);
  // Columns between samples that are not finite, where the curve breaks; within a unit it does not.
  const std::vector<std::vector<Column>>& runs() const { return runs_; }
  // The curve with all values multiplied.
  DrawnCurve scaled(double factor) const;

 private:
  struct Sample {
    double x = 0, value = 0;
  };

  Axis x_;
  double start_, step_;
  std::size_t count_ = 0;
  double unit_ = std::numeric_limits<double>::quiet_NaN();  // of x, whose column is the last; NaN: none is
  Sample least_, most_;                                     // of that column
  std::vector<std::vector<Column>> runs_{1};
};

}  // namespace intaglio::report
