// Meshes of known shape, for tests and for a first try: a quad, a sphere, a cylinder and a bowl.
//
// All stand in the world with their axis along +Y and their middle at the origin; `moved` (triangle_mesh.h)
// puts them elsewhere. Vertices lie on the shape itself and normals are the shape's own, so that a finer mesh
// is nearer to the shape.
#pragma once

#include "intaglio/surface/mesh/triangle_mesh.h"
#include "intaglio/surface/placement.h"

namespace intaglio::surface {

// Two triangles that are the rectangle of a Placement, u and v along its sides.
TriangleMesh make_quad(const Placement& placement);

// u goes once around the equator, eastwards; v from the south pole to the north pole. Normals outwards.
TriangleMesh make_sphere(double radius, int around, int up);

// The side only, without lids: u goes once around, v up the height. Normals outwards.
TriangleMesh make_cylinder(double radius, double height, int around, int up);

// The inside of the lower hemisphere: u goes once around, westwards; v from the bottom to the rim. Normals
// inwards.
TriangleMesh make_bowl(double radius, int around, int up);

}  // namespace intaglio::surface
