// Contacts of a body with a relief on a curved base: with a textured rectangle (a relief-mapped ball on a
// relief-mapped floor) and with another relief on a curved base (a relief-mapped ball in a relief-mapped
// bowl, or on another ball). Either may move. Pure; any thread; no allocation.
//
// The distance of the two is the smallest signed distance of any point of the body's relief from the ground's
// relief; it is negative below the ground (surface/closest.h, mesh/relief_closest.h).
//
// How it is found: the body's tree and lower bounds of the distance select the pieces that may be within the
// margin, and these are cut to the size of the ground's texels. On each piece two steps alternate: find the
// ground's point nearest to the current point of the piece, then the piece's lowest point along the direction
// between them. The distance decreases in every round, so the iteration ends in a local minimum of the piece.
// It can miss a second, lower minimum within the same texel: in the test's 2000 poses the error is at most
// 0.01 texel, 0.0002 on average (docs/curved.md). On flat ground nothing is missed.
#pragma once

#include <limits>

#include "contact/contact_point.h"
#include "mesh/relief_mesh.h"

namespace intaglio::contact {

// Contacts that push the body away from a rectangle; the body is at `pose` in the ground's world. Points, uv
// and n_s are of the ground. Only the rectangle counts. `margin` is limited to its shorter side. Where they
// overlap, the ground's texels that stick out are tested against the body, too, and count if they are deeper
// in it.
//
// A ground of finite thickness (relief on one side of a box) has a back side: parts of the body that are more
// than `thickness` below its deepest point, or deeper in it, are behind it and ignored.
//
// Cost: about 5 us for each piece within the margin or inside the ground. Keep the margin below a texel, and
// give the thickness of a ground that has a back side: otherwise everything behind it counts as penetrating.
ContactSet curved_on_relief(const surface::ReliefMesh& body, const Pose& pose, const surface::Surface& ground,
                            double margin, double thickness = std::numeric_limits<double>::infinity());

// Contacts that push the body away from another relief on a curved base; the body is at `pose` in the
// ground's frame. Points, uv and n_s are of the ground. Parts of the body deeper in the ground than `depth`
// are ignored; a body entirely inside is not detected.
//
// Cost: one closest-point query of the ground for every part of the body that is tested, some tens of
// milliseconds in all: meant for few bodies, not for games. Keep the margin below a texel.
ContactSet curved_on_curved(const surface::ReliefMesh& body, const Pose& pose,
                            const surface::ReliefMesh& ground, double margin, double depth);

}  // namespace intaglio::contact
