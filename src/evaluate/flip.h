// FLIP: how much two pictures seem to differ when they are shown in turn at the same place.
//
// Both pictures are 8-bit sRGB of equal size. Per pixel the error is 0 (no difference is seen) to 1 (as much
// as between pure green and pure blue). The colour part filters both pictures by the eye's contrast
// sensitivity in an opponent space, converts them to CIELAB with Hunt's correction, and measures the HyAB
// distance; the feature part compares edges and points of the lightness, and amplifies the colour part:
// error = colour^(1 - feature). `pixels_per_degree` is how many pixels a degree of the visual field holds;
// 67.02 is a display of 0.7 m with 3840 pixels seen from 0.7 m. Borders repeat their pixel. Symmetric in the
// two pictures. Bit-identical on x86-64 (docs/determinism.md).
//
// Any thread; allocates about 200 bytes a pixel; about 1 microsecond a pixel.
// Source: Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astrom, Fairchild, "FLIP: A Difference Evaluator
// for Alternating Images", Proc. ACM on Computer Graphics and Interactive Techniques 3(2), 2020.
#pragma once

#include "intaglio/error.h"
#include "intaglio/image.h"

namespace intaglio::evaluate {

inline constexpr double default_pixels_per_degree = 67.02064327658226;  // pi / 180 * 3840

struct FlipMap {
  Image<float> error;  // one channel, 0..1
  double mean = 0;     // of all pixels; the figure that FLIP reports
};

// Pictures with 3 channels, or 4, whose alpha is ignored. Errors: different or empty sizes, other channels,
// pixels per degree outside 1..1000.
Result<FlipMap> flip(const Image8& reference, const Image8& test,
                     double pixels_per_degree = default_pixels_per_degree);

// Pixels per degree of a display `width` metres and `pixels` pixels wide, seen from `distance` metres.
double pixels_per_degree_of(double distance, double pixels, double width);

}  // namespace intaglio::evaluate
