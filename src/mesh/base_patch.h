// One triangle of a mesh with its interpolated normal: which of its normal lines passes through a point, and
// how deep relief may go before those lines cross.
//
// At weights w the base point is x = w0 p0 + w1 p1 + w2 p2 and the normal has the direction
// N = w0 n0 + w1 n1 + w2 n2. Moved by s along N, the corners are q_i(s) = p_i + s n_i, and the triangle's
// normal, twice its area long, is a quadratic in s:
//   M(s) = (q1 - q0) x (q2 - q0) = a + b s + c s^2.
// A point of space lies in the plane of the moved triangle where
//   (point - p0 - s n0) . M(s) = 0,
// a cubic in s; the weights then follow from a linear solve. So the inverse of (w, s) -> x + s N is exact, no
// initial guess. The height above the base is s |N|.
//
// The Jacobian of that map is M(s) . N(w), linear in w, so its least value is at a corner. The map is one to
// one down to the depth d = -s where n_k . (a - b d + c d^2) first becomes zero at some corner k: the fold.
//
// Lengths in metres. Pure functions, no allocation. Cost: about 0.2 us for a projection.
#pragma once

#include <array>
#include <optional>

#include "intaglio/vec.h"
#include "mesh/triangle_mesh.h"

namespace intaglio::surface {

struct BasePatch {
  std::array<Vec3, 3> p;  // corners, counter-clockwise seen from outside
  std::array<Vec3, 3> n;  // unit normals at the corners

  Vec3 position(const Vec3& weights) const {
    return weights[0] * p[0] + weights[1] * p[1] + weights[2] * p[2];
  }
  Vec3 normal(const Vec3& weights) const {
    return (weights[0] * n[0] + weights[1] * n[1] + weights[2] * n[2]).normalized();
  }
};

BasePatch patch_of(const TriangleMesh& mesh, int triangle);

struct Projection {
  Vec3 weights;   // of the corners; sum 1, none below -1e-9
  double height;  // metres above the base along the interpolated normal; negative below
};

// The base point of the patch whose normal line passes through `point`, at most `reach` away and before any
// fold; of several the nearest. Absent when there is none.
std::optional<Projection> project(const BasePatch& patch, const Vec3& point, double reach);

// Bounding sphere of a patch and bounding cone of its normals; a cheap rejection test, a few nanoseconds.
struct PatchBounds {
  Vec3 middle;
  double radius;  // metres, around `middle`
  Vec3 axis;      // unit
  // Of the greatest angle between `axis` and an interpolated normal; 1 when that may be a right angle.
  double sine;

  explicit PatchBounds(const BasePatch& patch);
  // False only when no normal line reaches `point` from at most `reach` metres away.
  bool may_reach(const Vec3& point, double reach) const;
};

// Distance from `point` to the flat triangle, metres: a lower bound of |height|.
double triangle_distance(const BasePatch& patch, const Vec3& point);

// The depth below the base at which the patch folds; infinite when its normals do not meet below it. A lower
// bound: at least the true depth times the cosine of the largest angle between a corner's normal and their
// mean.
double fold_depth(const BasePatch& patch);

}  // namespace intaglio::surface
