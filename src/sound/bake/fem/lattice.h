// Tetrahedra that fill the region where a predicate is true: isosurface stuffing on a body-centred cubic
// lattice.
//
// Lattice points near the surface are moved onto it and the remaining cut tetrahedra are split, so that every
// element is well shaped and no surface mesh is needed: dirty input cannot make it fail. The lattice is
// stretched a little along each axis, so that whole cells fit between `low` and `high`: faces of a body that
// lie along the axes are represented exactly. Sharp edges elsewhere are cut off by a fraction of a cell.
// Cost: one call of `inside` for each lattice point near the surface, and one of `crossing` for each cut
// edge; without a result, twelve bisections by `inside`.
//
// Source: Labelle & Shewchuk, "Isosurface stuffing: fast tetrahedral meshes with good dihedral angles", 2007;
// the quadrilaterals are cut from their smallest index, not by its parity rule.
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
  std::array<int, 3> cells;  // between low and high, at least 1 each

  // With cells as close to `cell` as whole numbers of them allow.
  LatticeBox(const Vec3& low, const Vec3& high, const Vec3& cell);
  double points() const;  // number of lattice points, approximately
};

// The region to fill. `clearance` and `crossing` are optional accelerators.
struct SolidQuery {
  std::function<bool(const Vec3&)> inside;
  // Radius around the point with no change of `inside`, capped at `reach`, m.
  std::function<double(const Vec3&, double reach)> clearance = {};
  // Parameter of the surface on the segment, 0 at `in` to 1 at `out`, if it crosses exactly once.
  std::function<std::optional<double>(const Vec3& in, const Vec3& out)> crossing = {};
};

// Empty if nothing is solid.
CornerMesh fill_lattice(const LatticeBox& box, const SolidQuery& solid);

// The axes along which a body has most of its flat faces, so that a lattice aligned with them fits exactly.

// A rotation whose columns are the axes: the first is normal to the most area, the second to the most of the
// rest that is perpendicular to it. Identity where less than a twentieth of the area is flat. Only the 200
// largest triangles are candidates. About 1 ms for 1,000 triangles.
Mat3 flat_frame(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles);

}  // namespace intaglio::sound
