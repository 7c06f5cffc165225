// Contact points (include/intaglio/contact_point.h), and the paper's formulas for them.
#pragma once

#include "intaglio/contact_point.h"

namespace intaglio::contact {

using intaglio::ContactPoint;
using intaglio::ContactSet;
namespace status = contact_status;

// The contact point q (metres) of a sphere of centre c and radius r on a normal map: where it touches the
// plane that has the sampled unit normal n_s. An impulse along n_s through q passes through the centre and
// leaves the angular velocity unchanged.
// Eq. 1.2, Sterling & Lin 2016, §1.2.3.2
inline Vec3 sphere_contact_point(const Vec3& c, double r, const Vec3& n_s) {
  return c - r * n_s;
}

// Change of velocity (m/s) of a body of `mass` kg that a force of `force` newtons along the unit normal n
// pushes for `dt` seconds. The paper writes n_g; with a texture the sampled normal n_s takes its place.
// Eq. 1.1, Sterling & Lin 2016, §1.2.3
inline Vec3 velocity_change(double force, double dt, double mass, const Vec3& n) {
  return force * dt / mass * n;
}

}  // namespace intaglio::contact
