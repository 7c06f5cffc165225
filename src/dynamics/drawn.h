// Between where a body is on the relief that a normal map implies and where it is drawn: on the flat floor.
//
// Drawn, a body is as far above the floor as it is from the implied relief, over the same point of the map,
// and turned back by the map's mean tilt: it neither sinks nor floats, and nothing jumps. World frame;
// microseconds; any thread.
#pragma once

#include "contact/shape.h"
#include "surface/surface.h"

namespace intaglio::dynamics {

class Drawn {
 public:
  // `relief` lies over the same rectangle as the floor `map`; slopes are local.
  Drawn(const surface::Surface& map, const surface::Surface& relief, const Vec2& mean_slope);

  // Of a body that is on the relief.
  Pose pose(const contact::Shape& shape, const Pose& simulated) const;
  Vec3 point(const Vec3& simulated) const;
  Vec3 velocity(const Vec3& simulated) const;
  // Back: where on the relief a body must be to be drawn so.
  Pose simulated(const contact::Shape& shape, const Pose& drawn) const;
  Vec3 simulated_velocity(const Vec3& drawn) const;

 private:
  const surface::Surface& map_;
  const surface::Surface& relief_;
  Vec2 mean_slope_;
  Quat turned_back_;  // from the mean plane to the floor
};

}  // namespace intaglio::dynamics
