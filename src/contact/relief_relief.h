// Contacts of two textured rectangles, either of which may move: a relief on a body, a relief on the ground.
// Pure; any thread; no allocation.
//
// Each Surface is placed in the frame of its owner (surface.h), and the owner's pose takes that to the world;
// the identity for an owner that does not move. Contacts are corners of either relief (texels that stick out)
// against the patches of the other, and creases of the body's relief against corners, creases and patches of
// the ground's. Not detected: creases of the ground against the inside of a saddle of the body, and saddles
// against each other. Overlaps deeper than the greater of margin and a texel are ignored.
//
// Cost: proportional to the corners and creases within the margin of the other relief, some 1 us each.
#pragma once

#include "contact/contact_point.h"
#include "surface/surface.h"

namespace intaglio::contact {

struct PosedSurface {
  const surface::Surface& surface;
  Pose pose;  // of its owner, world
};

// Contacts that push `body` away from `ground`. Points, uv and n_s are of the ground's relief; `feature`
// identifies the corner of the body or of the ground, or the crease of the body.
ContactSet relief_relief_contacts(const PosedSurface& body, const PosedSurface& ground, double margin);

}  // namespace intaglio::contact
