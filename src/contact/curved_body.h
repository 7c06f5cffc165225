// A relief on a curved base, a body, against a textured rectangle, the ground: a relief-mapped ball on a
// relief-mapped floor. Either may move. Pure; any thread; no allocation.
//
// What the distance is: of every point of the body's relief the signed distance to the ground's, below it
// negative (closest.h), the least over the body; and where they overlap, of the ground's texels that stick
// into the body theirs to the body's relief, if that is deeper. Apart, it is the distance of the two fields.
//
// How it is found: the body's pieces that may be within the margin, by its tree and bounds of the ground
// below each, are cut to the size of the ground's texels; on each, from its lowest point, the nearest point
// of the ground and the piece's lowest point towards that take turns. That ends in a local minimum of the
// piece, so what may be missed is a second, lower one within the same texel: in 2000 poses of the test by
// 0.01 of a texel at most, 0.0002 on the mean (docs/curved.md). On a flat ground nothing is missed.
//
// A ground that is only so thick, the relief on one side of a box, has a back: what of the body is lower than
// its deepest place by more than `thickness`, or deeper in it, is behind it, and is not looked at.
//
// Cost: the pieces within the margin, or in the ground, some 5 us each; keep the margin below a texel, and of
// a ground with a back say how thick it is: else all that is behind counts as in it.
#pragma once

#include <limits>

#include "contact/contact_point.h"
#include "mesh/relief_mesh.h"

namespace intaglio::contact {

// Contacts that push the body away from the ground; the body is at `pose` in the ground's world. Points, uv
// and n_s are of the ground. Only the rectangle counts. `margin` is limited to its shorter side.
ContactSet curved_on_relief(const surface::ReliefMesh& body, const Pose& pose, const surface::Surface& ground,
                            double margin, double thickness = std::numeric_limits<double>::infinity());

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
// minimum of the piece, as in curved_body.h.
//
// Cost: a closest point of the ground for every part of the body that is looked at, some tens of
// milliseconds a query: for few bodies, not for a game. Keep the margin below a texel.

// Contacts that push the body away from the ground; the body is at `pose` in the ground's frame. Points, uv
// and n_s are of the ground.
ContactSet curved_on_curved(const surface::ReliefMesh& body, const Pose& pose,
                            const surface::ReliefMesh& ground, double margin, double depth);

}  // namespace intaglio::contact
