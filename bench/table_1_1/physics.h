// Physics for Table 1.1: what a step of a whole scene costs on each floor.
#pragma once

#include <string>
#include <vector>

#include "bench/timing.h"

namespace intaglio::bench {

struct PhysicsCost {
  std::string floor;
  Summary rolling, thrown;  // us a step of the scene, solver and all
  double build_ms = 0, bytes = 0;
};

// Two scenes on the 4 m brick of 512 x 512 texels at 60 Hz, thread-CPU time: 100 balls of 0.1 m that roll
// at 1.2 m/s, and 5 boxes and 5 balls thrown from half a metre, which fall, bounce, tumble and come to
// slide. Each round has all floors in turn, from the same throws. Floors: "normal map", "normal map,
// literal", "relief map", "coarse mesh" (256 x 256), "fine mesh", "fine height field", and "fine mesh,
// ours": its triangles under CurvedShape.
std::vector<PhysicsCost> measure_physics(int rounds);

}  // namespace intaglio::bench
