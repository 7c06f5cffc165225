// The generalised winding number of a triangle mesh: 1 inside, 0 outside, and something sensible between
// where the mesh is open, doubled or cuts through itself, so that "> 1/2" says what is solid.
//
// The solid angles of near triangles are exact, far ones count as one dipole a branch of the tree; the error
// is below 0.02. Immutable, safe from any thread, no allocation in a query; about 10 microseconds on 5,000
// triangles. Sources: Jacobson et al., "Robust inside-outside segmentation using generalized winding
// numbers", 2013; Barill et al., "Fast winding numbers for soups and clouds", 2018.
#pragma once

#include <set>
#include <vector>

#include "intaglio/vec.h"
#include "sound/bake/fem/body_surface.h"
#include "sound/triangle_grid.h"

namespace intaglio::sound {

class WindingNumber {
 public:
  // At least one triangle. Copies what it needs.
  WindingNumber(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles);

  double at(const Vec3& p) const;

 private:
  struct Branch {
    Vec3 middle;     // of its triangles, by area
    Vec3 dipole;     // sum of their area vectors, m^2
    double radius;   // of a ball around `middle` that holds them
    int first, end;  // of its triangles in corners_
    int right;       // the left child follows its parent; 0: a leaf
  };
  int build(std::vector<int>& order, const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
            int first, int end);
  double at(const Vec3& p, int branch) const;

  std::vector<Branch> branches_;
  std::vector<std::array<Vec3, 3>> corners_;
};

// The solid that a surface becomes when it is given a thickness: all that lies within half of it, straight
// out from the surface; at a rim it ends square.

class ThickShell {
 public:
  // Both must outlive it; body.thickness > 0.
  ThickShell(const BodySurface& body, const SurfaceQuery& surface);

  bool holds(const Vec3& p) const;

 private:
  const BodySurface& body_;
  const SurfaceQuery& surface_;
  std::set<std::pair<int, int>> rim_;  // edges of one triangle
};

}  // namespace intaglio::sound
