// The cost of a representation of the brick of 4 m, for each sense.
#pragma once

#include <memory>
#include <vector>

#include "bench/lod/lod_mesh.h"
#include "intaglio/error.h"

namespace intaglio::bench {

// One way to represent the relief: a texture, or a mesh.
struct LodWay {
  std::shared_ptr<const surface::Surface> texture;  // null: the mesh
  LodMesh mesh = {};
};

// Medians of CPU time.
struct LodCost {
  double picture_ms = 0;  // a frame of 320 x 180 drawn and read back, over three cameras
  double contact_us = 0;  // a 60 Hz step of 100 rolling balls, solver included
  double sound_ns = 0;    // a sample of the slope along a stroke at 44.1 kHz and 1 m/s, its place known
};

// Rounds with every way in turn. `full` is the relief above which balls start.
Result<std::vector<LodCost>> lod_costs(const std::shared_ptr<const surface::Surface>& full,
                                       const std::vector<LodWay>& ways, int rounds);

}  // namespace intaglio::bench
