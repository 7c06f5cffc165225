// The natural modes of a free elastic body: K U = M U Lambda with U^T M U = I.
//
// Block Lanczos (block_lanczos.h) with a negative shift, so that the factorised matrix is positive definite
// although K is not: the six rigid motions have eigenvalue zero and are found, counted and removed. Modes of
// one frequency come whole groups at a time and in one basis (modes.h), so that frequencies agree
// within 1e-10 and shapes within 1e-6 of their size whatever BLAS computed them. Cost: about 2.5 solves a
// mode; 100 modes of 100,000 degrees of freedom take some 8 s.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "intaglio/error.h"
#include "sound/bake/fem/elastic_system.h"

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

// One basis for modes that share a frequency.
//
// The mode shapes of equal frequencies (a ball's, a square plate's) are any rotation of each other, and
// which one a solver returns depends on how its arithmetic rounds. Here each group of modes of which each is
// within 1e-6 of the next in frequency gets its mean frequency and one fixed basis: the rotation that brings
// it nearest to as many fixed reference fields, pseudorandom by the number of the mesh's node (orthogonal
// Procrustes: with B = F^T U = P S Q^T, U becomes U Q P^T). A single mode gets its sign by the same rule.
// The result depends on the span of the group only, and a small change of the span changes it as little, but
// for a factor of the group's size. Pure; linear in the size of the shapes. Source: Golub & Van Loan,
// "Matrix Computations", 2013, §6.4.1 (orthogonal Procrustes problem).

// Neighbours in a list of ascending frequencies that are one group: their relative distance is below this.
inline constexpr double same_frequency = 1e-6;

// Where each group of modes of one frequency begins, and at last how many modes there are.
std::vector<Eigen::Index> frequency_groups(std::span<const double> angular_frequency);

void make_canonical(Modes& modes);

}  // namespace intaglio::sound
