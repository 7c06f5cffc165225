// Where the ears are, and how loud a source is in each: distance and direction, no room, no head.
//
// Pure, any thread. Pressure falls as 1 / distance from the metre at which sources are given, and no further
// inwards than `nearest`. Direction is a constant-power pan: what lies ahead (or behind, or above) is equally
// loud on both sides, at the pressure of its distance; the mean square of both sides is that of the pressure
// wherever the source is.
#pragma once

#include "intaglio/core/vec.h"

namespace intaglio::sound {

struct Listener {
  static constexpr double nearest = 0.1;  // m

  Vec3 position = Vec3(0, 0, 1);  // m, world
  Vec3 right = Vec3::UnitX();     // unit, towards the right ear
};

struct EarGains {
  float left = 1, right = 1;
};

EarGains ear_gains(const Listener& listener, const Vec3& source);

}  // namespace intaglio::sound
