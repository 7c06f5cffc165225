// How far a coarser representation of a relief is from the full one, for each sense.
#pragma once

#include <vector>

#include "bench/lod/lod_mesh.h"

namespace intaglio::bench {

// A relief as seen from above: height and unit normal at side x side samples, of row 0 at the bottom.
struct HeightRaster {
  int side = 0;
  double length = 0;  // m, of the square
  std::vector<float> z;
  std::vector<Eigen::Vector3f> normal;

  std::size_t at(int i, int j) const { return std::size_t(j) * std::size_t(side) + std::size_t(i); }
};

HeightRaster raster_of(const surface::Surface& surface, int side);
// Normals are interpolated between the vertices, as a picture does. Where the mesh folds the upper side
// counts.
HeightRaster raster_of(const LodMesh& mesh, double length, int side);

struct LodError {
  double normal_deg = 0;  // picture: RMS angle between the normals
  double depth_mm = 0;    // picture: RMS of the depth below the eye
  double ball_mm = 0;     // contact: RMS of the height at which a ball of 0.1 m rests, at 4,000 places
  // Sound: RMS over third-octave bands, up to the finest wave of the full texture, of the difference in
  // level of the spectrum of the slope along 96 straight strokes of 2 m.
  double sound_db = 0;
};

class LodErrors {
 public:
  explicit LodErrors(HeightRaster full);
  LodError of(const HeightRaster& other) const;

 private:
  HeightRaster full_;
  std::vector<double> balls_, bands_;
};

}  // namespace intaglio::bench
