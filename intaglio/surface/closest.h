// Closest features of the relief to a point: the bilinear patches and the creases between them.
//
// Local coordinates (placement.h), metres; the relief repeats beyond its rectangle as the surface's edge mode
// says, and it is the caller who cares where the rectangle ends. Under wrap the copy of the texture under the
// point and the eight around it are searched: enough for the nearest point, always, and for features as long
// as `reach` is within a side.
//
// Exact; no allocation; any thread. A nearest-first descent of the pyramid, pruned by the best distance so
// far (closest_search.h). Cost at 512 x 512, within 5 cm of a brick wall of 1 m (bench_surface):
// closest_point 1.2 to 1.5 us, closest_features of a ball that touches 4 to 5 us; at 4096 x 4096 three to
// four times that.
#pragma once

#include <optional>
#include <span>

#include "intaglio/surface/closest_cell.h"
#include "intaglio/surface/surface.h"

namespace intaglio::surface {

struct Feature {
  Vec3 point = Vec3::Zero();      // on the relief, local
  Vec3 direction = Vec3::Zero();  // unit, from the relief outwards to the asking point (its mirror image when
                                  // that is below the relief)
  double distance = 0;            // signed: negative when the asking point is below the relief
  int cell_i = 0, cell_j = 0;     // which patch
};

// The point of the relief that is nearest to p, wherever p is. Nothing only when p is not finite.
std::optional<Feature> closest_point(const Surface& surface, const Vec3& p);

// Local minima of the distance from p to the relief that are nearer than `reach` and turn their outer side to
// p, nearest first; of two whose directions differ by less than `min_angle` (radians, in 0..pi / 2, not
// 0) only the nearer is kept. A cell offers its nearest point only. Returns how many were written to `out`.
// All come from one descent: what the nearest made needless is kept and looked at again for the next, unless
// it lies wholly within min_angle of a feature already found; so flat ground costs little more than
// closest_point.
std::size_t closest_features(const Surface& surface, const Vec3& p, double reach, double min_angle,
                             std::span<Feature> out);

}  // namespace intaglio::surface
