// Tetrahedra that fill whatever a predicate calls solid: isosurface stuffing on a body-centred cubic lattice.
//
// Lattice points near the surface are moved onto it, what is left of the cut tetrahedra is split, so that
// every element is well shaped and no surface mesh is needed: dirty input cannot make it fail. The lattice is
// stretched a little along each axis, so that whole cells fit between `low` and `high`: the faces of a body
// that lie along the axes are met exactly. Sharp edges elsewhere are cut off by a fraction of a cell. Cost:
// one call of `inside` for each lattice point and twelve for each cut edge. Source: Labelle & Shewchuk,
// "Isosurface stuffing: fast tetrahedral meshes with good dihedral angles", 2007; the quadrilaterals are cut
// from their smallest index, not by its parity rule.
#pragma once

#include <functional>

#include "intaglio/sound/fem/tet_mesh.h"

namespace intaglio::sound {

struct LatticeBox {
  Vec3 low, high;            // the bounding box of the body
  Vec3 cell;                 // size of a cell along each axis, metres
  std::array<int, 3> cells;  // that fit between low and high, at least 1 each

  // With cells as near to `cell` as whole numbers of them allow.
  LatticeBox(const Vec3& low, const Vec3& high, double cell);
  double points() const;  // about so many lattice points
};

// Empty when nothing is solid.
CornerMesh fill(const LatticeBox& box, const std::function<bool(const Vec3&)>& inside);

}  // namespace intaglio::sound
