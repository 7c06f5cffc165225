// Contacts of a body with a relief on a curved base (mesh/relief_mesh.h). Same contract as
// surface_contacts.h: pure, any thread, no allocation, bounded, results always finite; invalid input is
// reported in ContactSet::status.
//
// The field is X = p + z n over the mesh with its interpolated unit normals, z = -depth bilinear between
// texels: that of MeshPlacement, so touch, haptics and rendering share one field. A facet of the mesh is flat
// where the relief is: curvature is only as good as the tessellation.
//
// Accuracy:
//
//   sphere    all closest features, to rounding (relief_closest.h);
//   capsule   both ends as spheres, and the least gap of its axis;
//   box, hull corners against the relief, to rounding; the relief against faces, the deepest point of each
//             piece of the relief that is within the margin. Before they touch, the gap at an edge of the
//             body is measured to the planes of its faces, which makes it too small by up to a half;
//   cylinder  likewise, its rims at 16 corners each;
//   mesh      its corners only.
//
// The solid is below the relief. A body deeper than twice its size gets status::under and no contact. Beyond
// the border of an open mesh nothing is below.
#pragma once

#include "contact/contact_point.h"
#include "contact/query.h"
#include "contact/shape.h"
#include "mesh/relief_closest.h"
#include "mesh/relief_mesh.h"

namespace intaglio::contact {

// `pose` in the frame of the mesh. Points nearer than `margin` (metres, 0 or more; limited to the mesh's
// size) are reported before they touch. Cost: docs/curved.md.
ContactSet curved_contacts(const surface::ReliefMesh& relief, const Shape& shape, const Pose& pose,
                           double margin);

// Shared with curved_body.cpp.
namespace internal {

// Feature id, independent of which adjacent cell or triangle was found. Ids may collide above 4096 texels a
// side, 256 features or 64 parts of the body.
std::uint64_t curved_feature_id(const surface::ReliefMesh& relief, int triangle, const Vec2& weights,
                                BodyFeature body, int index, int part);

// Selects candidates and fills uv and n_s from the base below each; sets status::limit when there were too
// many.
void select(const surface::ReliefMesh& relief, Candidates& found, ContactSet& set);

}  // namespace internal

}  // namespace intaglio::contact
