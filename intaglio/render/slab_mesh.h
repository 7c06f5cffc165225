// A textured slab as triangles: what is drawn in place of traced relief, to compare them. Pure; no OpenGL.
#pragma once

#include "intaglio/render/mesh.h"
#include "intaglio/surface/surface.h"

namespace intaglio::render {

// The relief sampled at `cells` x `cells` squares, two triangles each, cut walls down to z = -slab and a
// floor; local frame, metres, normals those of the surface. Where `cells` is twice the texels, every texel is
// a corner. Closed and outward. 24 bytes a corner and 24 a square; cost about 0.2 us a square.
Mesh slab_mesh(const surface::Surface& surface, int cells, double slab);

}  // namespace intaglio::render
