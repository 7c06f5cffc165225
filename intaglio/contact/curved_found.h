// Contacts with a relief on a curved base: their names, and what is reported of them. Internal to contact/.
#pragma once

#include "intaglio/contact/candidates.h"
#include "intaglio/surface/mesh/relief_closest.h"

namespace intaglio::contact {

// The name of a feature of the relief and a part of the body: the same whichever of the cells and triangles
// that meet there was found. Different ones may share a name above 4096 texels, 256 parts or 64 children.
std::uint64_t curved_feature_id(const surface::ReliefMesh& relief, int triangle, const Vec2& weights,
                                Part part, int index, int child);

// The chosen of those found, with the frame of the base below each.
void report(const surface::ReliefMesh& relief, Candidates& found, ContactSet& set);

}  // namespace intaglio::contact
