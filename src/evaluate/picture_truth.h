// How true a representation's pictures are, from steep to grazing, beside the reference's.
//
// The reference's picture is a fine mesh of the reference field, drawn by rasterisation and not by the
// relief shader; its depth is found by brute force along each pixel's ray. Needs EGL.
#pragma once

#include "evaluate/sight.h"
#include "evaluate/subject.h"

namespace intaglio::evaluate {

struct PictureTruth {
  double depth_mm = 0;      // root mean square over views and pixels that both see, along the view
  double normal_angle = 0;  // degrees, mean, of what Sight sees and the reference's normals
  double silhouette = 0;    // fraction of the surface's pixels at which only one of the pictures shows it
  double flip = 0;          // mean
  std::size_t device_bytes = 0;  // textures and meshes
};

// `pixels`: width of the pictures.
Result<PictureTruth> measure_picture(const Subject& subject, const Candidate& candidate, const Sight& sight,
                                     int pixels);

}  // namespace intaglio::evaluate
