// Contacts of the round bodies' cores with the relief. Internal to contact/.
#pragma once

#include "intaglio/contact/candidates.h"
#include "intaglio/surface/surface.h"

namespace intaglio::contact {

// A ball: the closest features of the relief to its centre (surface/closest.h), less the radius.
void ball_pairs(const surface::Surface& surface, const Vec3& centre, double radius, int index, int child,
                Candidates& found);

}  // namespace intaglio::contact
