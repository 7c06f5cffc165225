// Pairs of features of body and relief that touch or are about to (surface_contacts.h says what a contact is). Local
// frame, metres; no allocation; bounded by the texels near the feature. Internal to contact/.
//
// What counts as overlapping, distance < 0:
//   corner of the body, below the relief:   its nearest point of the relief, however deep;
//   face of the body, relief corner inside: when that corner is nearer to no other face that could rest on
//                                           it, and not less than half as far from any that is not turned
//                                           up (convex), or not deeper than `overlap` (mesh);
//   edge of the body and crease or patch:   not deeper than `overlap`, the greater of the margin and a
//                                           texel, nor than 1.5 times its point is below the relief; of a
//                                           round body that much of the axis below the relief.
// So of a convex body no depth is more than twice the way that the whole of it would have to be lifted.
// Each pair must be a least gap give or take pairs.h: the common normal among the outer normals of both
// features.
#pragma once

#include <span>

#include "contact/query.h"
#include "intaglio/vec.h"
#include "surface/surface.h"

namespace intaglio::contact {

struct Asked {
  const surface::Surface& surface;
  int child;
  double overlap;
  Candidates& found;
};

// Whether an edge's point p that overlaps so far along a normal is in the relief, and not much nearer to the
// way straight up: else the normal misleads, beside a wall or under a narrow ridge.
inline constexpr double most_over_vertical = 1.5;
inline bool is_way_out(const surface::Surface& surface, const Vec3& p, double distance) {
  const double under = -surface.depth(surface.placement().uv(p)) - p.z();
  return -distance <= most_over_vertical * under + 1e-9;
}

// A ball: the closest features of the relief to its centre (surface/closest.h), less the radius.
void ball_pairs(const Asked& asked, const Vec3& centre, double radius, int index);

// A corner, or the round end of a capsule (radius > 0). `around`: unit directions of the edges that leave it.
void corner_pairs(const Asked& asked, const Vec3& corner, std::span<const Vec3> around, double radius,
                  int index);

// A straight edge. Of a polyhedron, `inward` are the unit directions from the edge into its two faces; none
// for a capsule's axis.
struct StraightEdge {
  Vec3 a, b;
  std::span<const Vec3> inward;
  double radius;
  int index;
};
void edge_pairs(const Asked& asked, const StraightEdge& edge);

// The rim of a cylinder: a circle where the side meets the end with that outer normal.
struct Rim {
  Vec3 centre, normal;
  double radius;
  int index;
};
void rim_pairs(const Asked& asked, const Rim& rim);

// Corners, edges and faces of a polyhedron, its vertices multiplied by `scale` first (a box is a scaled
// cube).
void polyhedron_pairs(const Asked& asked, const Polyhedron& form, const Vec3& scale, const Frame& frame);

void cylinder_pairs(const Asked& asked, const Cylinder& cylinder, const Frame& frame);

// How far from a true least gap a pair of features may be and still be reported. Internal to contact/.
//
// A body that rests on a flat place is never exactly parallel to it: all corners that are about to touch must
// be reported, not only the one that is nearest by a hair.

// Corners of the body: sine of the angle by which the normal may leave the corner's cone of normals.
inline constexpr double corner_slack = 0.34;
// Faces and edges against the relief: likewise, 3 degrees.
inline constexpr double slack = 0.05;
// And when they overlap by more than an eighth of what counts: then a pair that is no least gap misleads.
inline constexpr double overlap_slack = 1e-3;
inline double slack_at(double distance, double overlap) {
  return distance > -0.125 * overlap ? slack : overlap_slack;
}
// A bend of the relief below this slope is no corner and no crease.
inline constexpr double flat_bend = 1e-6;

// An angle's slack as one of a slope whose square is given.
inline double slope_slack(double angle, double slope2) {
  return angle * (1 + slope2);
}

}  // namespace intaglio::contact
