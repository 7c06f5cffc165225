// Conversions between map images, fields and normals, and detection of the maps' conventions.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "intaglio/image.h"
#include "intaglio/vec.h"
#include "surface/fuse.h"
#include "surface/import.h"

namespace intaglio::surface {

// Decoded pixels: 0..1, except from floating-point files, which may hold any finite value.
using Pixels = Image<float>;

// Integer samples as decoded pixels.
template <class T>
Pixels to_unit_range(const Image<T>& image) {
  Pixels out(image.width, image.height, image.channels);
  std::transform(image.data.begin(), image.data.end(), out.data.begin(),
                 [](T v) { return float(v) / float(std::numeric_limits<T>::max()); });
  return out;
}

// Whether at least 80 % of the pixels are vectors of nearly unit length that point up.
bool looks_like_normals(const Pixels& image);
bool is_constant(const Pixels& image, int channel);

// Normals that a floating-point file stores in -1..1 are remapped to 0..1.
void map_signed_normals_to_unit_range(Pixels& image);
// Stretches values to 0..1 when some lie outside; returns whether it changed anything.
bool stretch_to_unit_range(Field& field);

struct MapSlopes {
  Slopes slopes;
  double clamped = 0;  // fraction of the texels whose slope was beyond max_slope
};

// Slopes of a normal map, green +Y assumed, clamped to max_slope.
MapSlopes read_slopes(const Pixels& image);
// One channel of a map, or the brightness of an RGB one, 0..1.
Field read_height(const Pixels& image, int channel);
// 8-bit RGB, row 0 = bottom.
Image8 read_colour(const Pixels& image);
Image8 default_colour();

Field resample(const Field& field, int width, int height);  // bilinear
void flip_rows(Field& field);
void negate(Field& field);
void invert(Field& field);  // 1 - value
void scale(Field& field, double factor);
void scale(Slopes& slopes, double factor);

std::vector<Vec3> normals_of(const Slopes& slopes);
// The normals of the same surface made `factor` times as deep.
void rescale_normals(std::vector<Vec3>& normals, double factor);
// Slopes of a height 0..1 by central differences, wrapped, for a full depth of `depth_fraction` of the side.
Slopes central_slopes(const Field& height, double depth_fraction);

// The conventions of a normal map and a height map, found by correlating the normals with the slopes of the
// height.
//
// Assume white = high and green = +Y. Where the assumptions hold, the slopes read from the normals and those
// of the height agree in sign along u and v. A height map whose white is deep disagrees along both, a green
// channel of -Y along v only. Correlations are taken at several scales, and the best counts: 8-bit
// quantisation corrupts the finest scale. Two maps whose rows run in opposite directions correlate only after
// one is flipped. Ambiguous: flipping both maps looks the same as green = -Y.
struct Detection {
  Green green = Green::plus_y;
  Polarity polarity = Polarity::height;
  bool rows_flipped = false;  // the height map's rows run the other way
  double correlation = 0;     // 0..1 after correction: root mean square of those along u and v
  double correlation_u = 0, correlation_v = 0;  // signed, as read under the assumptions
  // Full depth over the side of the tile at which the height's slopes match the normals' (least squares).
  double implied_depth = 0;

  // Below this the maps do not describe the same surface, or one of them is flat.
  static constexpr double min_correlation = 0.3;
  bool agrees() const { return correlation >= min_correlation; }
};

// `slopes` of the normals with +Y assumed, `height` 0..1 with white = high assumed; of equal size, row 0 =
// bottom.
Detection detect_conventions(const Slopes& slopes, const Field& height);

}  // namespace intaglio::surface
