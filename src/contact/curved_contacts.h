// Contacts with a relief on a curved base: their names, and what is reported of them. Internal to contact/.
#pragma once

#include "contact/contact_point.h"
#include "contact/query.h"
#include "contact/shape.h"
#include "mesh/relief_closest.h"
#include "mesh/relief_mesh.h"

namespace intaglio::contact {

// The name of a feature of the relief and a part of the body: the same whichever of the cells and triangles
// that meet there was found. Different ones may share a name above 4096 texels, 256 parts or 64 children.
std::uint64_t curved_feature_id(const surface::ReliefMesh& relief, int triangle, const Vec2& weights,
                                Part part, int index, int child);

// The chosen of those found, with the frame of the base below each.
void report(const surface::ReliefMesh& relief, Candidates& found, ContactSet& set);

// A body against a relief on a curved base (surface/mesh/relief_mesh.h): where it touches. As surface_contacts.h says
// it of a rectangle: pure, any thread, no allocation, bounded, never a number that is not finite; what is
// wrong with the question is said by ContactSet::status.
//
// The field is X = p + z n over the mesh with its interpolated unit normals, z = -depth bilinear between
// texels: that of MeshPlacement, so that what is felt and seen on the same mesh is meant here too. A facet of
// the mesh is flat where the relief is: a base is as round as its triangles are small.
//
// What is exact and what is not:
//   sphere    all closest features, to rounding (relief_closest.h);
//   capsule   both ends as spheres, and the least gap of its axis;
//   box, hull corners against the relief, to rounding; the relief against faces, the deepest point of each
//             piece of the relief that is within the margin. Before they touch, the gap of an edge of the
//             body is taken to its faces' planes: too small by up to a half of it;
//   cylinder  likewise, its rims at 16 corners each;
//   mesh      its corners only.
// The solid is below the relief. A body that is deeper in than twice its size is elsewhere: status::under and
// no contact. Beyond the border of an open mesh nothing is below.

// `pose` in the frame of the mesh. Points nearer than `margin` (metres, 0 or more; limited to the mesh's
// size) are reported before they touch. Cost: docs/curved.md.
ContactSet curved_contacts(const surface::ReliefMesh& relief, const Shape& shape, const Pose& pose,
                           double margin);

}  // namespace intaglio::contact
