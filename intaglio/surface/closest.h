// Closest features of the relief to a point: the bilinear patches and the creases between them.
//
// Local coordinates (placement.h), metres; the relief repeats beyond its rectangle as the surface's edge mode says, and it
// is the caller who cares where the rectangle ends. No allocation; any thread. Cost: one bound test for each cell
// under the ball of radius `reach`, and about 60 ns for each cell whose top is within reach.
#pragma once

#include <span>

#include "intaglio/surface/surface.h"

namespace intaglio::surface {

struct Feature {
  Vec3 point = Vec3::Zero();      // on the relief, local
  Vec3 direction = Vec3::Zero();  // unit, from the relief outwards to the asking point (its mirror image when that is below the relief)
  double distance = 0;            // signed: negative when the asking point is below the relief
  int cell_i = 0, cell_j = 0;     // which patch
};

// The point of one patch that is nearest to p, as (s, t) in 0..1.
Vec2 closest_on_cell(const Cell& cell, const Vec3& p);

// Local minima of the distance from p to the relief that are nearer than `reach`, nearest first; of two whose directions
// differ by less than `min_angle` (radians) only the nearer is kept. Returns how many were written to `out`.
std::size_t closest_features(const Surface& surface, const Vec3& p, double reach, double min_angle, std::span<Feature> out);

}  // namespace intaglio::surface
