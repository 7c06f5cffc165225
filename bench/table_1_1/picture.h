// Pictures for Table 1.1: what a frame costs in each representation.
#pragma once

#include <string>
#include <vector>

#include "bench/timing.h"
#include "intaglio/error.h"

namespace intaglio::bench {

struct PictureCost {
  std::string representation;
  int width = 0, height = 0;
  Summary frame;  // ms, CPU time of the process, all threads of the driver
  double device_bytes = 0;
};

struct PictureCosts {
  std::string device;
  std::vector<PictureCost> rows;
};

// The brick of 1 m, 512 x 512 texels, from three cameras, a frame drawn and read back: "normal map", "relief
// map", "coarse mesh" (255 x 255 squares displaced, shaded as the relief is: its normals, its self-shadow),
// "fine mesh" (511 x 511); "relief map, no shadow"; "coarse mesh, plain" and "fine mesh, plain", in one
// colour with the mesh's own normals, as the paper drew meshes; and "an empty picture", the cost of a frame
// whatever it shows. Each round has all of them in turn.
Result<PictureCosts> measure_pictures(int width, int height, int rounds);

}  // namespace intaglio::bench
