// A relief on a curved base, a body, against another, the ground: a relief-mapped ball in a relief-mapped
// bowl, or on another ball. Either may move. Pure; any thread; no allocation.
//
// What the distance is: of every point of the body's relief the signed distance to the ground's
// (surface/mesh/relief_closest.h), the least over the body. What of the body is deeper in the ground than
// `depth` is not looked at: a body that is wholly inside is not met.
//
// How it is found: the body's pieces that may be within the margin, by its tree and the distance of the
// ground from the middle of each, are cut to the size of the ground's texels; on each, from its middle, the
// nearest point of the ground and the piece's lowest point towards that take turns. That ends in a local
// minimum of the piece, as in curved_on_relief.h.
//
// Cost: a closest point of the ground for every part of the body that is looked at, some tens of
// milliseconds a query: for few bodies, not for a game. Keep the margin below a texel.
#pragma once

#include "intaglio/contact/contact_point.h"
#include "intaglio/surface/mesh/relief_mesh.h"

namespace intaglio::contact {

// Contacts that push the body away from the ground; the body is at `pose` in the ground's frame. Points, uv
// and n_s are of the ground.
ContactSet curved_on_curved(const surface::ReliefMesh& body, const Pose& pose,
                            const surface::ReliefMesh& ground, double margin, double depth);

}  // namespace intaglio::contact
