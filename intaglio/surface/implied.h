// The relief that a normal map implies: its normals integrated to a height.
//
// What bodies and tips move on when only normals are known, so that energy is right by construction. The mean
// height lies in the map's base plane. A mean slope above 0.001 is kept (then the result does not repeat, its
// edge mode is clamp, and its depth grows with the rectangle); below, it is rounding, and left out. Curl that
// no height can have is left out too (fuse.h). Cost: a few FFTs, 0.1 s at 512 x 512; any thread.
#pragma once

#include <memory>

#include "intaglio/surface/surface.h"

namespace intaglio::surface {

struct ImpliedRelief {
  std::shared_ptr<const Surface> surface;  // the map's normals on its implied height
  Vec2 mean_slope = Vec2::Zero();          // (dz/dx, dz/dy), local; zero when it was left out
};

ImpliedRelief implied_relief(const Surface& map);

}  // namespace intaglio::surface
