// The pixels of maps, read and turned: from images to fields and back to normals.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "intaglio/image.h"
#include "intaglio/vec.h"
#include "surface/fuse.h"
#include "surface/import.h"

namespace intaglio::surface {

// What decoded pixels are kept in: 0..1, but for floating-point files, which may hold anything finite.
using Pixels = Image<float>;

// Integer samples as decoded pixels.
template <class T>
Pixels unit_range(const Image<T>& image) {
  Pixels out(image.width, image.height, image.channels);
  std::transform(image.data.begin(), image.data.end(), out.data.begin(), [](T v) {
    return static_cast<float>(v) / static_cast<float>(std::numeric_limits<T>::max());
  });
  return out;
}

// Normal maps have vectors of nearly unit length that point up.
bool looks_like_normals(const Pixels& image);
bool is_constant(const Pixels& image, int channel);

// Normals that a floating-point file holds as they are, -1..1, become 0..1 like everyone's.
void encode_signed_normals(Pixels& image);
// Stretches values to 0..1 when some lie outside; whether it did.
bool normalise(Field& field);

// Slopes of a normal map, green +Y assumed, held within max_slope; `clamped` receives the fraction that was.
Slopes read_slopes(const Pixels& image, double* clamped);
// One channel of a map, or the brightness of an RGB one, 0..1.
Field read_height(const Pixels& image, int channel);
// 8-bit RGB, row 0 = bottom.
Image8 read_colour(const Pixels& image);
Image8 plain_colour();

Field resampled(const Field& field, int width, int height);  // bilinear
void flip_rows(Field& field);
void negate(Field& field);
void complement(Field& field);  // 1 - value
void scale(Field& field, double factor);
void scale(Slopes& slopes, double factor);

std::vector<Vec3> normals_of(const Slopes& slopes);
// The normals of the same surface made `factor` times as deep.
void rescale_normals(std::vector<Vec3>& normals, double factor);
// Slopes of a height 0..1 by central differences, wrapped, for a full depth of `depth_fraction` of the side.
Slopes central_slopes(const Field& height, double depth_fraction);

// What conventions a normal map and a height map were made with, found by correlating the normals with the
// slopes of the height.
//
// Assume white = high and green = +Y. Then the slopes read from the normals and those of the height agree in
// sign along u and v if the assumptions hold; a height map whose white is deep disagrees along both, a green
// channel of -Y along v only. Correlations are taken at several scales, the best of which counts: 8-bit
// terraces spoil the finest. Two maps whose rows run in opposite directions correlate only after one is
// flipped. What cannot be told: both maps upside down is the same as green -Y.

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
