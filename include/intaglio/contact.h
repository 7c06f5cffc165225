// Where a body touches a textured surface: contacts as values, for any physics engine.
//
//   for (const intaglio::ContactPoint& c : intaglio::contacts(wall, intaglio::Box{{0.1, 0.1, 0.1}}, pose))
//     engine.add(c.point, c.normal, c.distance, c.feature);     // examples/other_engine.cpp
//
// Pure functions: any thread, no allocation, bounded time, results always finite. ContactSet::status
// reports invalid queries. World frame, metres.
//
// A contact is a place where the gap between body and relief has a local minimum. While they are apart,
// `distance` is the Euclidean distance of the two points, and that of the first contact is the distance of
// body and relief. Where they overlap, it is minus the distance by which the two features must be moved apart
// along the normal. `feature` stays the same from step to step while the same features touch, so use it as
// the key for warm starting. Only points within the rectangle count; below the relief is solid. Cost: 1 to 30
// us (docs/contact-bench.md); docs/curved.md has it for curved surfaces.
#pragma once

#include "intaglio/contact_point.h"
#include "intaglio/mesh.h"
#include "intaglio/representation.h"
#include "intaglio/shape.h"
#include "intaglio/surface.h"
#include "intaglio/vec.h"

namespace intaglio {

struct ContactOptions {
  double margin = 0.01;  // m: points nearer than this are reported before they touch; 0 or more
  Representation representation = Representation::relief;
  ContactMethod method = ContactMethod::closest;  // of a relief on a rectangle
};

ContactSet contacts(const Surface& surface, const Shape& body, const Pose& pose,
                    const ContactOptions& options = {});

// Always with the relief; the margin is limited to the mesh's size.
ContactSet contacts(const CurvedSurface& surface, const Shape& body, const Pose& pose, double margin = 0.01);

}  // namespace intaglio
