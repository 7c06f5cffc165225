// Gives a lattice's tetrahedra the sharp edges of the surface that they fill: the lattice alone cuts edges
// off that run across it, which costs a body several per cent of pitch.
//
// Points of the boundary near a corner move onto it, those near an edge onto that; edges of elements that
// still cut a sharp one off are split where it passes. Each step is taken only where every element it touches
// stays well shaped, so nothing can fail: what cannot be kept stays cut off. Cost: some milliseconds for
// 5,000 elements.
#pragma once

#include "intaglio/sound/fem/sharp_edges.h"
#include "intaglio/sound/fem/surface_query.h"
#include "intaglio/sound/fem/tet_mesh.h"

namespace intaglio::sound {

// `cell` is that of the lattice, metres.
void keep_edges(CornerMesh& mesh, const SharpEdges& edges, const SurfaceQuery& surface, double cell);

}  // namespace intaglio::sound
