// Tetrahedra that fill whatever a predicate calls solid: isosurface stuffing on a body-centred cubic lattice.
//
// Lattice points near the surface are moved onto it, what is left of the cut tetrahedra is split, so that
// every element is well shaped and no surface mesh is needed: dirty input cannot make it fail. The lattice is
// stretched a little along each axis, so that whole cells fit between `low` and `high`: the faces of a body
// that lie along the axes are met exactly. Sharp edges elsewhere are cut off by a fraction of a cell. Cost:
// one call of `inside` for each lattice point near the surface, and one of `crossing` for each cut edge; each
// that knows none costs twelve more of `inside`. Source: Labelle & Shewchuk,
// "Isosurface stuffing: fast tetrahedral meshes with good dihedral angles", 2007; the quadrilaterals are cut
// from their smallest index, not by its parity rule.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "intaglio/vec.h"
#include "sound/bake/fem/tet_mesh.h"
#include "sound/triangle_grid.h"

namespace intaglio::sound {

struct LatticeBox {
  Vec3 low, high;            // the bounding box of the body
  Vec3 cell;                 // size of a cell along each axis, metres
  std::array<int, 3> cells;  // that fit between low and high, at least 1 each

  // With cells as near to `cell` as whole numbers of them allow.
  LatticeBox(const Vec3& low, const Vec3& high, const Vec3& cell);
  double points() const;  // about so many lattice points
};

// What is solid. The last two only save calls of `inside`.
struct Solid {
  std::function<bool(const Vec3&)> inside;
  // How far around a point all is as the point is, at most `reach`, metres.
  std::function<double(const Vec3&, double reach)> clearance = {};
  // Where, from 0 at `in` to 1 at `out`, the surface is, if it is met just once.
  std::function<std::optional<double>(const Vec3& in, const Vec3& out)> crossing = {};
};

// Empty when nothing is solid.
CornerMesh fill(const LatticeBox& box, const Solid& solid);

// The axes along which a body has most of its flat faces, so that a lattice laid along them meets those
// exactly.

// A rotation whose columns are the axes: the first is normal to the most area, the second to the most of the
// rest that is perpendicular to it. Identity where less than a twentieth of the area is flat. Only the 200
// largest triangles are candidates. About 1 ms for 1,000 triangles.
Mat3 flat_frame(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles);

}  // namespace intaglio::sound
