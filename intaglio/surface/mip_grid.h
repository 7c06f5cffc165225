// The grid of texels of one mip level: how an index goes on beyond the border, and where a coordinate falls.
//
// Pure functions of integers and fractions; any thread; a few nanoseconds.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace intaglio::surface {

enum class Edge { wrap, clamp };

struct Grid {
  int width = 0;
  int height = 0;
  Edge edge = Edge::wrap;

  std::size_t size() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
  // Where texel (i, j) is stored; i, j any integer.
  std::size_t index(int i, int j) const { return row(j) + column(i); }
  std::size_t column(int i) const { return static_cast<std::size_t>(within(i, width)); }
  std::size_t row(int j) const {
    return static_cast<std::size_t>(within(j, height)) * static_cast<std::size_t>(width);
  }
  int within(int i, int n) const {
    if (static_cast<unsigned>(i) < static_cast<unsigned>(n)) return i;
    if (edge == Edge::clamp) return i < 0 ? 0 : n - 1;
    const int m = i % n;
    return m < 0 ? m + n : m;
  }
};

// Splits a texel coordinate into the cell's index and the place in it. Something that is not a number counts
// as far away.
struct Split {
  int index;
  double fraction;

  explicit Split(double coordinate) {
    // Far outside (a body a million metres away) the texture is periodic anyway: stay within int.
    const double bounded = coordinate > -1e9 ? std::min(coordinate, 1e9) : -1e9;
    const double floor = std::floor(bounded);
    index = static_cast<int>(floor);
    fraction = bounded - floor;
  }
};

}  // namespace intaglio::surface
