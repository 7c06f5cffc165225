// Touch for Table 1.1: what a servo tick costs in each representation.
#pragma once

#include <string>
#include <vector>

#include "bench/timing.h"
#include "intaglio/error.h"

namespace intaglio::bench {

struct TouchCost {
  std::string representation, method;
  Summary tick;           // us, thread-CPU time, of batches of 32 ticks
  double touching = 0;    // share of ticks with a force
  double mean_force = 0;  // N, up, of those
};

// A tip that slides over the brick of 1 m, 1 to 6 mm deep, at up to 0.4 m/s, as in bench_haptics. "servo":
// the whole tick (device, proxy, friction, damping, passivity, guard), on the texture or on a Solid of the
// mesh's triangles (TexturedMesh without relief). "proxy": contact alone, on the texture by ours and on
// the triangles by a finger proxy that knows they are a grid (triangle_proxy.h). Each round has all of
// them in turn.
Result<std::vector<TouchCost>> measure_touch(int ticks, int rounds);

}  // namespace intaglio::bench
