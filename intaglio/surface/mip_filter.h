// Interpolation on a grid of texels: bilinear (what the relief is) and Catmull-Rom bicubic (C1, for forces).
//
// A layout (Grid, TexelTiles) says with row(j) + column(i) where texel (i, j) is stored, and `fetch(k)` gives
// the value stored at k. Derivatives are per texel. No allocation; any thread. Source: Catmull and Rom, "A
// class of local interpolating splines", 1974.
#pragma once

#include <array>

#include "intaglio/surface/mip_grid.h"

namespace intaglio::surface {

struct Interpolated {
  double value, d_x, d_y;
};

// The 2 x 2 texels around a coordinate (in texels, texel centres at integers), rows one after the other.
struct BilinearTaps {
  std::array<std::size_t, 4> index;
  double x, y;  // place between them, 0..1

  template <class Layout>
  BilinearTaps(const Layout& layout, double coordinate_x, double coordinate_y) {
    const Split sx(coordinate_x), sy(coordinate_y);
    const std::size_t left = layout.column(sx.index), right = layout.column(sx.index + 1);
    const std::size_t low = layout.row(sy.index), high = layout.row(sy.index + 1);
    index = {low + left, low + right, high + left, high + right};
    x = sx.fraction;
    y = sy.fraction;
  }
  std::array<double, 4> weights() const { return {(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y}; }

  template <class Fetch>
  Interpolated operator()(const Fetch& fetch) const {
    const double a = fetch(index[0]), b = fetch(index[1]), c = fetch(index[2]), d = fetch(index[3]);
    const double low = a + x * (b - a), high = c + x * (d - c);
    return {low + y * (high - low), (b - a) + y * (d - c - b + a), high - low};
  }
};

// Weights of four neighbours for the place f in 0..1 between the middle two, and their derivatives.
struct CatmullRom {
  std::array<double, 4> weight, slope;

  explicit CatmullRom(double f) {
    const double f2 = f * f, f3 = f2 * f;
    weight = {-0.5 * f + f2 - 0.5 * f3, 1 - 2.5 * f2 + 1.5 * f3, 0.5 * f + 2 * f2 - 1.5 * f3,
              -0.5 * f2 + 0.5 * f3};
    slope = {-0.5 + 2 * f - 1.5 * f2, -5 * f + 4.5 * f2, 0.5 + 4 * f - 4.5 * f2, -f + 1.5 * f2};
  }
};

template <class Layout, class Fetch>
Interpolated bicubic(const Layout& layout, double coordinate_x, double coordinate_y, const Fetch& fetch) {
  const Split sx(coordinate_x), sy(coordinate_y);
  const CatmullRom cx(sx.fraction), cy(sy.fraction);
  std::array<std::size_t, 4> column;
  for (int k = 0; k < 4; ++k) column[static_cast<std::size_t>(k)] = layout.column(sx.index - 1 + k);
  Interpolated sum{0, 0, 0};
  for (std::size_t r = 0; r < 4; ++r) {
    const std::size_t row = layout.row(sy.index - 1 + static_cast<int>(r));
    double value = 0, slope = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const double texel = fetch(row + column[k]);
      value += cx.weight[k] * texel;
      slope += cx.slope[k] * texel;
    }
    sum.value += cy.weight[r] * value;
    sum.d_x += cy.weight[r] * slope;
    sum.d_y += cy.slope[r] * value;
  }
  return sum;
}

}  // namespace intaglio::surface
