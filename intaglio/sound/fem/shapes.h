// Structured ten-node meshes of the built-in shapes, centred at the origin, in metres.
//
// The curved ones are straight-sided lattices mapped radially, mid-edge nodes included, so that elements stay
// well shaped everywhere and no corner of one degenerates on the curved surface. Sizes must be positive and
// counts at least 1.
#pragma once

#include "intaglio/sound/fem/tet_mesh.h"

namespace intaglio::sound {

// A ball: an icosahedron of 20 tetrahedra around the centre, each cut into eight `level` times (20 * 8^level
// in all). Level 2 puts the first modes within 0.1 %.
TetMesh ball(double radius, int level);

// A box of `size`, cut into nx * ny * nz bricks of six tetrahedra, each the mirror image of its neighbours:
// where counts are even the mesh has the symmetry of the box, and modes that are degenerate stay so.
TetMesh box(const Vec3& size, int nx, int ny, int nz);

// A cylinder whose axis is local Y: a disk of 6 * rings^2 triangles, extruded through `layers`.
TetMesh cylinder(double radius, double length, int rings, int layers);

}  // namespace intaglio::sound
