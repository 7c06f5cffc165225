// Where a body touches a textured surface: contacts as values, for any physics engine.
//
//   for (const intaglio::ContactPoint& c : intaglio::contacts(wall, intaglio::Box{{0.1, 0.1, 0.1}}, pose))
//     engine.add(c.point, c.normal, c.distance, c.feature);     // examples/other_engine.cpp
//
// Pure functions: any thread, no allocation, bounded, never a number that is not finite; what is wrong with a
// query is in ContactSet::status. World frame, metres.
//
// A contact is a place where the gap between body and relief is least among its neighbours. Apart, `distance`
// is the Euclidean distance of the two points, and the first contact's is that of body and relief. Overlapping,
// it is minus the way that the two features must be moved apart along the normal. `feature` stays the same from
// step to step while the same features touch: key warm starting by it. Only points within the rectangle count;
// below the relief is solid. Cost: 1 to 30 us (docs/contact-bench.md); on curved surfaces docs/curved.md.
#pragma once

#include "intaglio/contact_point.h"
#include "intaglio/mesh.h"
#include "intaglio/representation.h"
#include "intaglio/shape.h"
#include "intaglio/surface.h"

namespace intaglio {

struct ContactOptions {
  double margin = 0.01;  // m: points nearer than this are reported before they touch; 0 or more
  Representation representation = Representation::relief;
  ContactMethod method = ContactMethod::closest;  // of a relief on a rectangle
};

ContactSet contacts(const Surface& surface, const Shape& body, const Pose& pose, const ContactOptions& options = {});

// Relief always; the margin is limited to the mesh's size.
ContactSet contacts(const CurvedSurface& surface, const Shape& body, const Pose& pose, double margin = 0.01);

}  // namespace intaglio
