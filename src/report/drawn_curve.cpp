#include "report/drawn_curve.h"

#include <cmath>

namespace intaglio::report {

void DrawnCurve::add(double value) {
  const Sample here{x_(start_ + double(count_++) * step_), value};
  if (!std::isfinite(here.x) || !std::isfinite(value)) {
    if (std::floor(here.x) == unit_) return;
    unit_ = std::numeric_limits<double>::quiet_NaN();
    if (!runs_.back().empty()) runs_.emplace_back();
    return;
  }
  if (here.x < x_.units().low - 1 || here.x > x_.units().high + 1) return;
  if (std::floor(here.x) != unit_) {
    unit_ = std::floor(here.x);
    least_ = most_ = here;
    runs_.back().emplace_back();
  } else if (value < least_.value) {
    least_ = here;
  } else if (value > most_.value) {
    most_ = here;
  } else {
    return;
  }
  const bool falls = most_.x < least_.x;
  const Sample &first = falls ? most_ : least_, &second = falls ? least_ : most_;
  runs_.back().back() = {first.x, first.value, second.x, second.value};
}

DrawnCurve DrawnCurve::scaled(double factor) const {
  DrawnCurve out = *this;
  for (std::vector<Column>& run : out.runs_) {
    for (Column& column : run) {
      column.first_value *= factor;
      column.second_value *= factor;
    }
  }
  return out;
}

}  // namespace intaglio::report
