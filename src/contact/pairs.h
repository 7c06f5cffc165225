// Pairs of features of body and relief that touch or are about to (surface_contacts.h says what a contact
// is). Local frame, metres; no allocation; cost bounded by the number of texels near the feature. Internal to
// contact/.
//
// Pairs count as overlapping, distance < 0:
//
//   corner of the body, below the relief:   its nearest point of the relief, however deep;
//   face of the body, relief corner inside: convex: no other face that could rest on it is nearer, and no
//                                           downward face is less than half as far; mesh: not deeper than
//                                           `max_penetration`;
//   edge of the body and crease or patch:   not deeper than `max_penetration`, the greater of the margin and
//                                           a texel, nor than 1.5 times its point is below the relief; for a
//                                           capsule or cylinder measured at the axis.
//
// So a convex body's reported depth is at most twice the distance it would have to be lifted. Each pair must
// be a local minimum of the gap, within the tolerances below: the common normal lies in the normal cone of
// both features. A pair that is nearly one, or proves an overlap without being one, is kept as a substitute
// (Candidates in query.h).
#pragma once

#include <cmath>
#include <span>

#include "contact/leaf_walk.h"
#include "contact/query.h"
#include "intaglio/vec.h"
#include "surface/surface.h"

namespace intaglio::contact {

// Tolerances on the normals of a feature pair. A body resting on a flat place is never exactly parallel to
// it: every corner about to touch is reported, not only the one that is nearest by rounding.

// Corners of the body: sine of the angle by which the normal may leave the corner's cone of normals.
inline constexpr double corner_slack = 0.34;
// Faces and edges against the relief: likewise, 3 degrees.
inline constexpr double normal_slack = 0.05;
// Tighter once they overlap by more than an eighth of the maximum penetration, where a pair that is not a
// minimum gives a wrong direction.
inline constexpr double deep_normal_slack = 1e-3;
inline double normal_slack_at(double distance, double max_penetration) {
  return distance > -0.125 * max_penetration ? normal_slack : deep_normal_slack;
}

// Whether a direction lies in a corner's cone of normals, within corner_slack. `edges`: unit directions of
// the edges that leave the corner.
bool is_in_corner_cone(const Vec3& direction, std::span<const Vec3> edges);

struct PairQuery {
  const surface::Surface& surface;
  int part;  // of the shape
  double max_penetration;
  Candidates& found;
};

// A sphere: the closest features of the relief to its centre (surface/closest.h), less the radius.
void sphere_pairs(const PairQuery& query, const Vec3& centre, double radius, int index);

// A corner, or the round end of a capsule (radius > 0). `edges`: unit directions of the edges that leave it.
void corner_pairs(const PairQuery& query, const Vec3& corner, std::span<const Vec3> edges, double radius,
                  int index);

// A straight edge. For a polyhedron, `inward` are the unit directions from the edge into its two faces; none
// for the axis of a capsule or cylinder.
struct StraightEdge {
  Vec3 a, b;
  std::span<const Vec3> inward;
  double radius;
  int index;
};
void edge_pairs(const PairQuery& query, const StraightEdge& edge);

// Whether moving point p by -distance along the normal is a plausible way out: p is below the relief and the
// vertical way up is not much shorter. Fails beside walls and under narrow ridges, where the normal misleads.
bool is_plausible_exit(const surface::Surface& surface, const Vec3& p, double distance);

// Shared by straight edges and rims.

struct EdgeContact {
  ReliefFeature feature;  // with texel (c, r) of the leaf
  int c, r;
  Vec3 point, normal;  // of the relief
  Vec3 on_edge;        // the edge's point
  double distance;     // between them
  double radius;       // around the edge
  double lean;         // sine of the angle by which -normal leaves the edge's cone of normals
  bool is_minimum;
};
// Adds a pair that is a local minimum and whose normal lies in the edge's cone; an overlapping one that is
// not becomes a fallback.
void add_edge_contact(const PairQuery& query, const Leaf& leaf, int index, const EdgeContact& contact);

// Where an edge crosses the crease from texel (c, r) to (c + x, r + y) in plan, at p over height z: if it is
// below, they overlap, and that is a last resort. A crease that enters the body must cross such an edge,
// unless one of its ends is inside.
void add_crossing(const PairQuery& query, const Leaf& leaf, int c, int r, int x, int index, const Vec3& p,
                  double z);

// Root of f in from..to, where it has opposite signs, by the Illinois variant of regula falsi.
template <class Function>
double find_root(const Function& f, double from, double to, double f_from, double f_to, double tolerance) {
  for (int iteration = 0; iteration < 60 && std::abs(to - from) > tolerance; ++iteration) {
    const double next = to - f_to * (to - from) / (f_to - f_from), value = f(next);
    if (value == 0) return next;
    if ((value < 0) == (f_to < 0)) {
      f_from *= 0.5;
    } else {
      from = to;
      f_from = f_to;
    }
    const bool has_converged = std::abs(next - to) < 1e-13;
    to = next;
    f_to = value;
    if (has_converged) break;
  }
  return to;
}

}  // namespace intaglio::contact
