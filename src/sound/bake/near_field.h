// The air beside a vibrating surface, as if it could not be compressed: the velocity potential on the
// surface.
//
// Within less than a wavelength that is what air does, and it decides how much of a vibration gets away: what
// one part pushes out the next one sucks in. Solved is the exterior Neumann problem of Laplace's equation,
// D Phi = (1/2 + K') u, with D the hypersingular operator, in Maue's form by surface curls, and K' the
// adjoint double layer; linear elements on the corners, Galerkin. D stays well-conditioned however thin the
// body is. It leaves the mean of Phi open, which the equation (1/2 - K) Phi = V u gives. Cost: triangles^2 *
// 50 ns and points^3 / 3 multiplications; 1 s for 2,000 triangles. Any thread. Sources: Steinbach, "Numerical
// approximation methods for elliptic boundary value problems", 2008, ch. 6-7; Maue, 1949.
#pragma once

#include <vector>

#include "intaglio/vec.h"
#include "sound/triangle_grid.h"

namespace intaglio::sound {

// Surfaces that are closed, or nearly, triangles outward and with area; what bounds a hollow inside must have
// been taken out (outside_of). `velocity`: a row for each triangle, a column for each case, outward,
// m/s; the answer is Phi in the same order, m^2/s: the pressure is rho dPhi/dt.
Eigen::MatrixXd near_potential(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                               const Eigen::MatrixXd& velocity);

// What a triangle covered evenly with sources does at a point: the exact integrals of 1 / r and of its normal
// derivative.
//
// Pure, any thread; about 0.1 us. The point may be anywhere, also on the triangle. Source: Wilton et al.,
// "Potential integrals for uniform and linear source distributions on polygonal and polyhedral domains",
// 1984.

struct TrianglePotential {
  double single = 0;  // integral of 1 / r, m
  // Integral of the derivative of 1 / r along the triangle's normal (right-handed): the solid angle under
  // which it is seen, positive from the side the normal points to; 0 in its plane.
  double twice = 0;
};

// A triangle without area has none.
TrianglePotential triangle_potential(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c);

// The connected parts of a triangle mesh.
//
// Pure, any thread; linear but for a logarithm.

struct SurfaceParts {
  std::vector<int> of_point;  // numbered from 0; a point of no triangle is a part of its own
  int count = 0;
};
SurfaceParts surface_parts(std::size_t points, const std::vector<Triangle>& triangles);

// The triangles that have area and do not bound a hollow inside a body, out of which no sound gets: of parts
// that enclose a negative volume.
std::vector<Triangle> outside_of(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles);

}  // namespace intaglio::sound
