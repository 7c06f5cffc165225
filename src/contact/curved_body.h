// Contacts of a body with a relief on a curved base: with a textured rectangle (a relief-mapped ball on a
// relief-mapped floor) and with another relief on a curved base (a relief-mapped ball in a relief-mapped
// bowl, or on another ball). Either may move. Pure; any thread; no allocation.
//
// Distance: the least, over all points of the body's relief, of the signed distance to the ground's, negative
// below it (surface/closest.h, mesh/relief_closest.h).
//
// How it is found: the body's pieces that may be within the margin, by its tree and a bound of the ground's
// distance from each, are cut to the size of the ground's texels. On each, two steps alternate: the ground's
// point nearest to the piece's, and the piece's lowest point in the direction from there. The distance falls
// at every turn, so that ends in a local minimum of the piece; a second, lower one within the same texel may
// be missed: in the test's 2000 poses off by at most 0.01 texel, 0.0002 on average (docs/curved.md). On a
// flat ground nothing is missed.
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
// Cost: the pieces within the margin, or in the ground, some 5 us each; keep the margin below a texel, and
// give the thickness of a ground that has a back: otherwise everything behind counts as penetrating.
ContactSet curved_on_relief(const surface::ReliefMesh& body, const Pose& pose, const surface::Surface& ground,
                            double margin, double thickness = std::numeric_limits<double>::infinity());

// Contacts that push the body away from another relief on a curved base; the body is at `pose` in the
// ground's frame. Points, uv and n_s are of the ground. Parts of the body deeper in the ground than `depth`
// are ignored; a body entirely inside is not detected.
//
// Cost: a closest point of the ground for every part of the body that is tested, some tens of milliseconds a
// query: meant for few bodies, not for games. Keep the margin below a texel.
ContactSet curved_on_curved(const surface::ReliefMesh& body, const Pose& pose,
                            const surface::ReliefMesh& ground, double margin, double depth);

}  // namespace intaglio::contact
