// A convex piece of a triangle, in weights (a, b) of its second and third corner; the first has 1 - a - b.
//
// On the stack; counter-clockwise. A triangle cut by the lines of a grid has at most seven corners.
#pragma once

#include <array>
#include <cstddef>

#include "intaglio/core/vec.h"

namespace intaglio::surface {

class WeightPolygon {
 public:
  static constexpr std::size_t most_corners = 16;

  static WeightPolygon triangle() {
    WeightPolygon out;
    out.add({0, 0});
    out.add({1, 0});
    out.add({0, 1});
    return out;
  }

  std::size_t size() const { return count_; }
  bool is_empty() const { return count_ < 3; }
  const Vec2& operator[](std::size_t k) const { return corners_[k]; }
  const Vec2* begin() const { return corners_.data(); }
  const Vec2* end() const { return corners_.data() + count_; }
  void add(const Vec2& corner) {
    if (count_ < most_corners) corners_[count_++] = corner;
  }
  Vec2 middle() const {
    Vec2 sum = Vec2::Zero();
    for (const Vec2& corner : *this) sum += corner;
    return sum / static_cast<double>(count_);
  }

  // The parts with slope . (a, b) + offset at most 0, and at least 0.
  void split(const Vec2& slope, double offset, WeightPolygon& below, WeightPolygon& above) const {
    double value = slope.dot(corners_[0]) + offset;
    for (std::size_t k = 0; k < count_; ++k) {
      const Vec2 &here = corners_[k], &there = corners_[k + 1 < count_ ? k + 1 : 0];
      const double next = slope.dot(there) + offset;
      if (value <= 0) below.add(here);
      if (value >= 0) above.add(here);
      if ((value < 0 && next > 0) || (value > 0 && next < 0)) {
        const Vec2 between = here + value / (value - next) * (there - here);
        below.add(between);
        above.add(between);
      }
      value = next;
    }
  }

 private:
  std::array<Vec2, most_corners> corners_;
  std::size_t count_ = 0;
};

}  // namespace intaglio::surface
