// Two textured rectangles against each other, either of which may move: a relief on a body, a relief on the
// ground. Pure; any thread; no allocation.
//
// Each Surface is placed in the frame of its owner (surface.h), and the owner's pose takes that to the
// world; the identity for what does not move. Contacts are corners of either relief (texels that stick out)
// against the patches of the other, and creases of the body's relief against corners, creases and patches of
// the ground's. Not looked for: creases of the ground that touch the inside of a saddle of the body, and
// saddles that touch each other. What overlaps by more than the greater of margin and a texel does not count.
//
// Cost: proportional to the corners and creases that are within the margin of the other relief, some 1 us
// each.
#pragma once

#include "contact/contact_point.h"
#include "surface/surface.h"

namespace intaglio::contact {

struct PlacedSurface {
  const surface::Surface& surface;
  Pose pose;  // of its owner, world
};

// Contacts that push `body` away from `ground`. Points, uv and n_s are of the ground's relief; both names of
// a corner of the body and of the ground are in `feature`.
ContactSet relief_relief_contacts(const PlacedSurface& body, const PlacedSurface& ground, double margin);

}  // namespace intaglio::contact
