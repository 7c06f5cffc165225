// Fusion: one height field from a quantised height map and a normal map.
//
// The fused height minimises |D h - s|^2 + lambda |h - h0|^2 over the tile (a screened Poisson problem,
// solved exactly by FFT): low frequencies come from the height, slopes from the normals. lambda is the ratio
// of the two maps' noise powers (Wiener's weighting), worked out from their quantisation steps, not chosen.
// Without a height map (h0 absent, lambda 0) the normals are integrated to an implied height. Units: heights
// in texels, slopes dimensionless. Cost: three FFTs; a 1024 x 1024 tile takes about half a second, 8192 x
// 8192 about a minute and 2.5 GB. Sources: Frankot & Chellappa 1988 (integration in the Fourier domain); Bhat
// et al. 2008 (screened Poisson).
#pragma once

#include "intaglio/surface/field.h"

namespace intaglio::surface {

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

}  // namespace intaglio::surface
