// One triangle of a mesh with its interpolated normal: which of its normal lines passes through a point, and
// how deep relief may go before those lines cross.
//
// At weights w the base point is x = w0 p0 + w1 p1 + w2 p2 and the normal has the direction N = w0 n0 + w1 n1
// + w2 n2. Moved by s along N, the corners are q_i = p_i + s n_i, and a point of space lies in their triangle
// where
//   det[q1 - q0, q2 - q0, point - q0] = 0,
// a cubic in s. So the inverse is a cubic's root and a linear solve: exact, without a start value. The height
// above the base is s |N|. The map is one to one while the moved triangle still faces along its normals;
// where it stops is the fold. Lengths in metres. Pure functions, no allocation. Cost: about 0.2 us for a
// projection.
#pragma once

#include <array>
#include <optional>

#include "intaglio/vec.h"

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

struct Projection {
  Vec3 weights;   // of the corners; sum 1, none below -1e-9
  double height;  // metres above the base along the interpolated normal; negative below
};

// The base point of the patch whose normal line passes through `point`, at most `reach` away and before any
// fold; of several the nearest. Absent when there is none.
std::optional<Projection> project(const BasePatch& patch, const Vec3& point, double reach);

// What all base points and normal lines of a patch stay within: a ball and a cone. A few nanoseconds to rule
// a patch out.
struct PatchBounds {
  Vec3 middle;
  double radius;  // metres, around `middle`
  Vec3 axis;      // unit
  double sine;  // of the greatest angle between `axis` and an interpolated normal; 1 when that may be a right
                // angle

  explicit PatchBounds(const BasePatch& patch);
  // False only when no normal line reaches `point` from at most `reach` metres away.
  bool may_reach(const Vec3& point, double reach) const;
};

// Distance from `point` to the flat triangle, metres. No height is less.
double flat_distance(const BasePatch& patch, const Vec3& point);

// The depth below the base at which the patch folds; infinite when its normals do not meet below it. At the
// corners exact; in between a lower bound, 1 - cos of the angle between the normals too small at most.
double fold_depth(const BasePatch& patch);

}  // namespace intaglio::surface
