// What conventions a normal map and a height map were made with, found by correlating the normals with the
// slopes of the height.
//
// Assume white = high and green = +Y. Then the slopes read from the normals and those of the height agree in
// sign along u and v if the assumptions hold; a height map whose white is deep disagrees along both, a green
// channel of -Y along v only. Correlations are taken at several scales, the best of which counts: 8-bit
// terraces spoil the finest. Two maps whose rows run in opposite directions correlate only after one is
// flipped. What cannot be told: both maps upside down is the same as green -Y.
#pragma once

#include "intaglio/surface/field.h"
#include "intaglio/surface/import.h"

namespace intaglio::surface {

struct Detection {
  Green green = Green::plus_y;
  Polarity polarity = Polarity::height;
  bool rows_differ = false;  // the height map's rows run the other way
  double correlation = 0;    // 0..1 after correction: root mean square of those along u and v
  double correlation_u = 0, correlation_v = 0;  // signed, as read under the assumptions
  double implied_depth = 0;  // full depth over the side of the tile at which the height's slopes are the
                             // normals' (least squares)

  // Below this the maps do not describe the same surface, or one of them is flat.
  static constexpr double least_correlation = 0.3;
  bool agrees() const { return correlation >= least_correlation; }
};

// `slopes` of the normals with +Y assumed, `height` 0..1 with white = high assumed; the same size, row 0 =
// bottom.
Detection detect(const Slopes& slopes, const Field& height);

}  // namespace intaglio::surface
