// Eq. 1.2, Sterling & Lin 2016, §1.2.3.2: the contact point of a sphere on a normal map.
#pragma once

#include "intaglio/core/vec.h"

namespace intaglio::contact {

// The point q (metres) at which a sphere of centre c and radius r touches the plane that the sampled unit
// normal n_s stands for. An impulse along n_s through q goes through the centre and leaves the angular
// velocity as it was.
// Eq. 1.2, Sterling & Lin 2016, §1.2.3.2
inline Vec3 sphere_contact_point(const Vec3& c, double r, const Vec3& n_s) {
  return c - r * n_s;
}

}  // namespace intaglio::contact
