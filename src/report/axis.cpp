#include "report/axis.h"

#include <algorithm>
#include <cmath>

namespace intaglio::report {

void Extent::add(double value) {
  if (!std::isfinite(value)) return;
  low_ = std::min(low_, value);
  high_ = std::max(high_, value);
}

Range Extent::range(const Range& fallback) const {
  // Differences of values near the largest double are infinite: fall back.
  if (!(low_ <= high_) || !std::isfinite(2 * low_) || !std::isfinite(2 * high_)) return fallback;
  const Range range{low_, high_};
  const double least = 1e-9 * std::max(std::abs(low_), 1e-3);
  if (range.size() < least) return {low_ - 0.5 * std::max(least, 1e-3), high_ + 0.5 * std::max(least, 1e-3)};
  return range;
}

Axis::Axis(const Range& values, const Range& units, AxisScale scale)
    : values_(values), units_(units), scale_(scale) {}

double Axis::operator()(double value) const {
  const double fraction = scale_ == AxisScale::linear
                              ? (value - values_.low) / values_.size()
                              : std::log(value / values_.low) / std::log(values_.high / values_.low);
  return units_.low + fraction * units_.size();
}

std::vector<double> Axis::ticks(int count) const {
  std::vector<double> ticks;
  if (scale_ == AxisScale::logarithmic) {
    for (double decade = std::pow(10, std::floor(std::log10(values_.low))); decade <= values_.high;
         decade *= 10) {
      for (const double value : {decade, 2 * decade, 5 * decade}) {
        if (value >= values_.low && value <= values_.high) ticks.push_back(value);
      }
    }
    return ticks;
  }
  const double rough = values_.size() / std::max(count, 1);
  const double power = std::pow(10, std::floor(std::log10(rough)));
  const double spacing = power * (rough / power < 1.5   ? 1
                                  : rough / power < 3.5 ? 2
                                  : rough / power < 7.5 ? 5
                                                        : 10);
  // Multiples of the spacing, not sums of it, which would drift off the round values.
  for (double k = std::ceil(values_.low / spacing - 1e-9); k * spacing <= values_.high + 1e-9 * spacing;
       ++k) {
    ticks.push_back(k * spacing);
  }
  return ticks;
}

}  // namespace intaglio::report
