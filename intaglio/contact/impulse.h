// Eq. 1.1, Sterling & Lin 2016, §1.2.3: what an impulse along a normal does to a body's velocity.
#pragma once

#include "intaglio/core/vec.h"

namespace intaglio::contact {

// Change of velocity (m/s) of a body of `mass` kg that a force of `force` newtons along the unit normal n
// pushes for `dt` seconds. The paper writes n_g; with a texture the sampled normal n_s takes its place.
// Eq. 1.1, Sterling & Lin 2016, §1.2.3
inline Vec3 velocity_change(double force, double dt, double mass, const Vec3& n) {
  return force * dt / mass * n;
}

}  // namespace intaglio::contact
