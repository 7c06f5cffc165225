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
#pragma once

#include <span>
#include <vector>

#include "intaglio/sound/fem/modes.h"

namespace intaglio::sound {

// Neighbours in a list of ascending frequencies that are one group: their relative distance is below this.
inline constexpr double same_frequency = 1e-6;

// Where each group of modes of one frequency begins, and at last how many modes there are.
std::vector<Eigen::Index> frequency_groups(std::span<const double> angular_frequency);

void make_canonical(Modes& modes);

}  // namespace intaglio::sound
