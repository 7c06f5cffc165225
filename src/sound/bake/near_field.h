// The near field of a vibrating surface: the velocity potential on the surface, with the air treated as
// incompressible.
//
// Within less than a wavelength air behaves so, and it sets the radiation efficiency: air moves from one part
// of the surface to the next instead of radiating. Solves the exterior Neumann problem of Laplace's equation
// by D Phi = (1/2 + K') u, with D the hypersingular operator, in Maue's form by surface curls, and K' the
// adjoint double layer; linear elements on the corners, Galerkin. D stays well-conditioned however thin the
// body is. It determines Phi up to a constant, which (1/2 - K) Phi = V u fixes (derivation in
// near_field.cpp). Cost: triangles^2 * 50 ns and points^3 / 3 multiplications; 1 s for 2,000 triangles. Any
// thread. Sources: Steinbach, "Numerical approximation methods for elliptic boundary value problems", 2008,
// ch. 6-7; Maue, 1949.
#pragma once

#include <vector>

#include "intaglio/vec.h"
#include "sound/triangle_grid.h"

namespace intaglio::sound {

// The surface must be closed, or nearly, with triangles outward and of positive area, and without internal
// cavities (outer_triangles). `velocity`: m/s outward, a row per triangle, a column per case. Returns Phi in
// the same order, m^2/s: the pressure is rho dPhi/dt.
Eigen::MatrixXd incompressible_potential(const std::vector<Vec3>& points,
                                         const std::vector<Triangle>& triangles,
                                         const Eigen::MatrixXd& velocity);

// The potential of a uniform source layer on a triangle: the exact integrals of 1 / r and of its normal
// derivative.
//
// Pure, any thread; about 0.1 us. The point may be anywhere, also on the triangle. Source: Wilton et al.,
// "Potential integrals for uniform and linear source distributions on polygonal and polyhedral domains",
// 1984.

struct TrianglePotential {
  double single_layer = 0;  // integral of 1 / r, m
  // Integral of the derivative of 1 / r along the triangle's normal (right-handed): the solid angle that the
  // triangle subtends, positive from the side the normal points to; 0 in its plane.
  double double_layer = 0;
};

// Zero for a degenerate triangle.
TrianglePotential triangle_potential(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c);

// The connected parts of a triangle mesh. Pure, any thread; near-linear.

struct SurfaceParts {
  std::vector<int> part_of_point;  // numbered from 0; an unreferenced point is a part of its own
  int count = 0;
};
SurfaceParts surface_parts(std::size_t points, const std::vector<Triangle>& triangles);

// Drops degenerate triangles and the walls of internal cavities (parts that enclose a negative volume), out
// of which no sound gets.
std::vector<Triangle> outer_triangles(const std::vector<Vec3>& points,
                                      const std::vector<Triangle>& triangles);

}  // namespace intaglio::sound
