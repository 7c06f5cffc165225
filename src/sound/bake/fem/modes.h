// The natural modes of a free elastic body: K U = M U Lambda with U^T M U = I.
//
// Block Lanczos (block_lanczos.h) with a negative shift, so that the factorised matrix is positive definite
// although K is not: the six rigid motions have eigenvalue zero and are found, counted and removed. Modes of
// equal frequency are returned as complete groups in a canonical basis (make_canonical), so that frequencies
// agree within 1e-10 and shapes within 1e-6 of their size whatever BLAS computed them. Cost: about 2.5 solves
// per mode; 100 modes of 100,000 degrees of freedom take some 8 s.
#pragma once

#include <atomic>
#include <functional>
#include <span>
#include <vector>

#include "intaglio/error.h"
#include "sound/bake/fem/elastic_system.h"

namespace intaglio::sound {

struct ModeOptions {
  int count = 100;                            // modes; any that share the last one's frequency are added
  double min_frequency = 20;                  // Hz, lower limit
  double max_frequency = 20'000;              // Hz, upper limit
  std::function<void(double)> progress = {};  // called with the converged fraction of the modes
  const std::atomic<bool>* stop = nullptr;    // set to abandon the bake with an error (elastic_system.h)
};

struct Modes {
  Eigen::VectorXd angular_frequency;  // rad/s, ascending
  Eigen::MatrixXd shape;              // one mode per column, kg^-1/2
  double highest_rigid = 0;           // rad/s, of the six rigid modes: 0 but for rounding
  double residual = 0;                // the worst |K u - lambda M u| / (lambda |M u|)
};

// Fails if the matrices do not have exactly six rigid modes (a part is loose, or the mesh is broken), if the
// iteration does not converge, or if options.stop is set. The result is empty if no mode lies in the range.
Result<Modes> free_modes(const ElasticSystem& system, const ModeOptions& options);

// One basis for modes that share a frequency.
//
// Mode shapes of equal frequency (a ball's, a square plate's) are defined only up to a rotation, and which
// one a solver returns depends on how its arithmetic rounds. Here each group of modes, each within 1e-6 of
// the next in frequency, gets its mean frequency and one fixed basis: the rotation that brings it nearest to
// as many fixed reference fields, pseudorandom by node number (orthogonal Procrustes: with B = F^T U = P S
// Q^T, U becomes U Q P^T). A single mode gets its sign by the same rule. The result depends only on the span
// of the group, and changes no more than the span does, up to a factor of the group's size. Pure; linear in
// the size of the shapes. Source: Golub & Van Loan, "Matrix Computations", 2013, §6.4.1 (orthogonal
// Procrustes problem).

// Adjacent ascending frequencies belong to one group if their relative distance is below this.
inline constexpr double frequency_tolerance = 1e-6;

// Start index of each group of modes of equal frequency, then the number of modes.
std::vector<Eigen::Index> frequency_groups(std::span<const double> angular_frequency);

void make_canonical(Modes& modes);

}  // namespace intaglio::sound
