// From faces to the edges and neighbours of a polyhedron. Internal to contact/.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "intaglio/contact/polyhedron.h"

namespace intaglio::contact {

// Half edges (from, to) and the face to their left.
using HalfEdges = std::map<std::pair<int, int>, int>;

// Half edges of all loops; an error when one belongs to two faces or has no partner the other way.
Result<HalfEdges> half_edges(const Polyhedron& form, const std::string& what);

// Fills edges, neighbours and radius from vertices, faces and loop.
void link(Polyhedron& form, const HalfEdges& half);

}  // namespace intaglio::contact
