// Fusion: one height field from a quantised height map and a normal map.
//
// The fused height h minimises |D h - s|^2 + lambda |h - h0|^2 over the tile (a screened Poisson problem,
// solved exactly by FFT): low frequencies come from the height map h0, slopes s from the normals. lambda is
// the ratio of the two maps' noise powers (Wiener weighting); it is computed from the quantisation steps, not
// tuned. Without a height map (lambda 0) the normals are integrated to an implied height. Units: heights in
// texels, slopes dimensionless. Cost: three FFTs; a 1024 x 1024 tile takes about half a second, 8192 x 8192
// about a minute and 2.5 GB. Sources: Frankot & Chellappa 1988 (integration in the Fourier domain); Bhat et
// al. 2008 (screened Poisson).
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <vector>

#include "surface/surface.h"

namespace intaglio::surface {

// A scalar field on the texel grid: row 0 = bottom (v = 0), texels square.
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

enum class Transform { forward, inverse };

// Two-dimensional discrete Fourier transform in place, of any size (small prime factors are fast). `data` is
// height x width; the inverse divides by width x height. O(n log n); a megapixel takes about 0.15 s.
void fft2(std::vector<std::complex<float>>& data, int width, int height, Transform transform);

enum class FuseEdge {
  periodic,  // the tile repeats
  mirrored,  // the tile does not repeat: it is mirrored, so that borders need not match
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
  double lambda = 0;  // the weight, 1/texel^2
  double curl = 0;    // root of the fraction of the slopes' energy that is not curl-free, 0..1
  // Of the normals; removed, because a periodic height has zero mean slope.
  double mean_slope_x = 0, mean_slope_y = 0;
};

Fused fuse(FuseInput input);

// Noise power of slopes from normals whose three components are rounded to `step`, each with variance step^2
// / 12. With L^2 = 1 + p^2 + q^2 = 1 / n_z^2, the slope p = -n_x / n_z has the derivatives 1 / n_z by n_x and
// n_x / n_z^2 by n_z, hence the variance step^2 / 12 L^2 (1 + p^2); the mean of both axes is
//   step^2 / 12 L^2 (1 + (p^2 + q^2) / 2),
// averaged over the tile.
double slope_noise(const Slopes& slopes, double step);

// The relief that a normal map implies: its normals integrated to a height.
//
// Used for dynamics when only a normal map exists, so that forces are conservative. With s the slopes of the
// normals, m their mean and c the middle of the rectangle, the height is
//   z(x) = h(x) + m . (x - c),   h: s - m integrated by fuse(), of mean zero;
// its mean lies in the map's base plane. If |m| is above 0.001, the
// result does not repeat, its edge mode is clamp, and its depth grows with the rectangle. A smaller m is
// treated as rounding and removed, as is curl. Cost: a few FFTs, 0.1 s at 512 x 512; any thread.
struct ImpliedRelief {
  std::shared_ptr<const Surface> surface;  // the map's normals on its implied height
  Vec2 mean_slope = Vec2::Zero();          // (dz/dx, dz/dy), local; zero when it was removed
};

ImpliedRelief implied_relief(const Surface& map);

}  // namespace intaglio::surface
