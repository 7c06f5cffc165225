// Faces of the body against the corners of the relief, and all pairs of a polyhedron. Internal to contact/.
#pragma once

#include "contact/leaf_walk.h"
#include "contact/pairs.h"

namespace intaglio::contact {

// Corners, edges and faces of a polyhedron, its vertices multiplied by `scale` first: a box is a scaled cube.
void polyhedron_pairs(const PairQuery& query, const Polyhedron& form, const Vec3& scale, const Frame& frame);

// A flat face of the body.
struct FlatFace {
  Vec3 normal;  // unit, outwards, down
  double offset;
  Vec2 low, high;  // of its corners, in plan
  int index;
};

// Whether -outward lies in the normal cone of a relief corner, within `angle`: a face with that normal can
// rest on it.
inline bool can_rest_on(const Leaf& leaf, int c, int r, const Vec3& outward, double angle) {
  return outward.z() < 0 && leaf.is_summit_along(c, r, -outward, angle);
}

// A box always has a face with n.z <= -1 / sqrt(3). Faces less downward than this only serve as a last
// resort.
inline constexpr double min_downward = -0.57;

// counts(q, distance, can_rest) says whether a corner q of the relief at that distance from the face's plane
// counts; can_rest(outward) says whether another face with that normal could rest on it.
template <class Counts>
void flat_face_pairs(const PairQuery& query, const FlatFace& face, const Counts& counts) {
  const Vec3& n = face.normal;
  Candidates& found = query.found;
  const Vec2 margin = Vec2::Constant(std::max(found.max_distance(), query.max_penetration));
  const auto visit = [&](int i, int j) {
    const Leaf leaf(query.surface, i, j);
    for (int r = leaf.begin_r; r < leaf.end_r; ++r) {
      for (int c = leaf.begin_c; c < leaf.end_c; ++c) {
        const Vec3 q = leaf.texel(c, r);
        const double distance = n.dot(q) - face.offset;
        if (!(distance <= found.max_distance())) continue;
        const Candidate candidate{q, -n, distance,
                                  feature_id(leaf.i + c, leaf.j + r, ReliefFeature::corner, BodyFeature::face,
                                             face.index, query.part)};
        const bool is_minimum = leaf.is_convex(c, r) &&
                                can_rest_on(leaf, c, r, n, normal_slack_at(distance, query.max_penetration));
        if (is_minimum) {
          if (counts(q, distance,
                     [&](const Vec3& other) { return can_rest_on(leaf, c, r, other, normal_slack); }))
            found.add(candidate);
        } else if (distance < 0 && !found.overlaps() &&
                   counts(q, distance, [](const Vec3&) { return false; })) {
          if (n.z() < min_downward)
            found.add_fallback(candidate);
          else
            found.add_last_resort(candidate);
        }
      }
    }
  };
  for_each_leaf(
      query.surface, face.low - margin, face.high + margin,
      [&](const SlabPiece& piece) {
        return piece.lower_bound({n.dot(piece.middle) - face.offset, n}) <= found.max_distance();
      },
      visit);
}

}  // namespace intaglio::contact
