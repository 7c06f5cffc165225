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

#include "intaglio/core/vec.h"
#include "intaglio/sound/triangle_grid.h"

namespace intaglio::sound {

// Surfaces that are closed, or nearly, triangles outward and with area; what bounds a hollow inside must have
// been taken out (outside_of). `velocity`: a row for each triangle, a column for each case, outward,
// m/s; the answer is Phi in the same order, m^2/s: the pressure is rho dPhi/dt.
Eigen::MatrixXd near_potential(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                               const Eigen::MatrixXd& velocity);

}  // namespace intaglio::sound
