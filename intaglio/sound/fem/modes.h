// The natural modes of a free elastic body: K U = M U Lambda with U^T M U = I.
//
// Block Lanczos (block_lanczos.h) with a negative shift, so that the factorised matrix is positive definite
// although K is not: the six rigid motions have eigenvalue zero and are found, counted and removed. Modes of
// one frequency come whole groups at a time and in one basis (canonical_basis.h), so that frequencies agree
// within 1e-10 and shapes within 1e-6 of their size whatever BLAS computed them. Cost: about 2.5 solves a
// mode; 100 modes of 100,000 degrees of freedom take some 8 s.
#pragma once

#include <functional>

#include "intaglio/core/error.h"
#include "intaglio/sound/fem/assemble.h"

namespace intaglio::sound {

struct ModeOptions {
  int count = 100;                            // so many modes, and those that share the last one's frequency,
  double min_frequency = 20;                  // Hz, of those in the range of hearing
  double max_frequency = 20'000;              // Hz
  std::function<void(double)> progress = {};  // told what fraction of the modes has converged
};

struct Modes {
  Eigen::VectorXd angular_frequency;  // rad/s, ascending
  Eigen::MatrixXd shape;              // one mode a column, kg^-1/2
  double highest_rigid = 0;           // rad/s, of the six modes that should be 0
  double residual = 0;                // the worst |K u - lambda M u| / (lambda |M u|)
};

// Fails when the matrices do not have exactly six rigid modes (a part is loose, or the mesh is broken) or
// when the iteration does not converge. A body without a mode in the range gives none.
Result<Modes> free_modes(const ElasticSystem& system, const ModeOptions& options);

}  // namespace intaglio::sound
