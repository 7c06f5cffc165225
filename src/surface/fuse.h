// Plain fields on the texel grid, as import works with them: row 0 = bottom (v = 0), texels square.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <vector>

#include "surface/surface.h"

namespace intaglio::surface {

struct Field {
  int width = 0;
  int height = 0;
  std::vector<float> value;  // height x width

  Field() = default;
  Field(int w, int h) : width(w), height(h), value(std::size_t(w) * std::size_t(h)) {}

  bool empty() const { return value.empty(); }
  float& at(int x, int y) { return value[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
  float at(int x, int y) const { return value[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
};

// Slopes of the height: dz/dx along u and dz/dy along v (up the image), both dimensionless.
struct Slopes {
  Field x, y;

  bool empty() const { return x.empty(); }
};

// Two-dimensional discrete Fourier transform of a complex field, in place, any size (small prime factors are
// fast).

enum class Transform { forward, inverse };

// `data` is height x width; the inverse divides by width x height. O(n log n); a megapixel takes about 0.15
// s.
void fft2(std::vector<std::complex<float>>& data, int width, int height, Transform transform);

// Fusion: one height field from a quantised height map and a normal map.
//
// The fused height minimises |D h - s|^2 + lambda |h - h0|^2 over the tile (a screened Poisson problem,
// solved exactly by FFT): low frequencies come from the height, slopes from the normals. lambda is the ratio
// of the two maps' noise powers (Wiener's weighting), worked out from their quantisation steps, not chosen.
// Without a height map (h0 absent, lambda 0) the normals are integrated to an implied height. Units: heights
// in texels, slopes dimensionless. Cost: three FFTs; a 1024 x 1024 tile takes about half a second, 8192 x
// 8192 about a minute and 2.5 GB. Sources: Frankot & Chellappa 1988 (integration in the Fourier domain); Bhat
// et al. 2008 (screened Poisson).

enum class FuseEdge {
  periodic,  // the tile repeats
  mirrored,  // it does not: continued by reflection, so that nothing is forced to match across the border
};

struct FuseInput {
  Field height;  // texels; may be empty
  Slopes slopes;
  double height_step = 0;  // quantisation step of the height, texels
  double normal_step = 0;  // quantisation step of a normal's components (2/255 for 8 bits)
  FuseEdge edge = FuseEdge::periodic;
};

struct Fused {
  Field height;       // texels; of mean zero when there was no height map
  Slopes slopes;      // of that height
  double lambda = 0;  // the weight that was used, 1/texel^2
  double curl = 0;    // share of the slopes that no height can have, 0..1 (root of the energy ratio)
  double mean_slope_x = 0,
         mean_slope_y = 0;  // of the normals; a periodic height cannot have them, so they are left out of it
};

Fused fuse(const FuseInput& input);

// Noise power of slopes that come from normals whose components are rounded to `step`: mean of (step^2 / 12)
// L^2 (1 + (p^2 + q^2)/2) with L^2 = 1 + p^2 + q^2, over the tile.
double slope_noise(const Slopes& slopes, double step);

// The relief that a normal map implies: its normals integrated to a height.
//
// What bodies and tips move on when only normals are known, so that energy is right by construction. The mean
// height lies in the map's base plane. A mean slope above 0.001 is kept (then the result does not repeat, its
// edge mode is clamp, and its depth grows with the rectangle); below, it is rounding, and left out. Curl that
// no height can have is left out too (fuse.h). Cost: a few FFTs, 0.1 s at 512 x 512; any thread.

struct ImpliedRelief {
  std::shared_ptr<const Surface> surface;  // the map's normals on its implied height
  Vec2 mean_slope = Vec2::Zero();          // (dz/dx, dz/dy), local; zero when it was left out
};

ImpliedRelief implied_relief(const Surface& map);

}  // namespace intaglio::surface
