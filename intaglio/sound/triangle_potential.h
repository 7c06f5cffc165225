// What a triangle covered evenly with sources does at a point: the exact integrals of 1 / r and of its normal
// derivative.
//
// Pure, any thread; about 0.1 us. The point may be anywhere, also on the triangle. Source: Wilton et al.,
// "Potential integrals for uniform and linear source distributions on polygonal and polyhedral domains",
// 1984.
#pragma once

#include "intaglio/core/vec.h"

namespace intaglio::sound {

struct TrianglePotential {
  double single = 0;  // integral of 1 / r, m
  // Integral of the derivative of 1 / r along the triangle's normal (right-handed): the solid angle under
  // which it is seen, positive from the side the normal points to; 0 in its plane.
  double twice = 0;
};

// A triangle without area has none.
TrianglePotential triangle_potential(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace intaglio::sound
