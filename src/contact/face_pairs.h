// A flat side of the body against the corners of the relief. Internal to contact/.
#pragma once

#include "contact/leaf_walk.h"
#include "contact/pairs.h"

namespace intaglio::contact {

struct Side {
  Vec3 normal;  // unit, outwards, down
  double offset;
  Vec2 low, high;  // of its corners, in plan
  int index;
};

// Whether a corner of the relief has -outward among its normals, give or take an angle: whether a side with
// that outer normal can rest on it.
inline bool can_rest_on(const Leaf& leaf, int c, int r, const Vec3& outward, double angle) {
  const double x = -outward.x() / outward.z(), y = -outward.y() / outward.z();
  return outward.z() < 0 && leaf.is_summit(c, r, x, y, slope_slack(angle, x * x), slope_slack(angle, y * y));
}

// Every convex body has a side that is turned down as much.
inline constexpr double under_side = -0.57;

// inside(q, distance, rests) says whether a corner q of the relief at that distance from the plane counts;
// rests(outward) says whether another side could rest on it.
template <class Inside>
void side_pairs(const Asked& asked, const Side& side, const Inside& inside) {
  const Vec3& n = side.normal;
  const Vec2 aside = Vec2::Constant(std::max(asked.found.limit(), asked.overlap));
  const auto visit = [&](int i, int j) {
    const Leaf leaf(asked.surface, i, j);
    const double bend_x = -flat_bend * leaf.w, bend_y = -flat_bend * leaf.h;
    for (int r = leaf.begin_r; r < leaf.end_r; ++r) {
      for (int c = leaf.begin_c; c < leaf.end_c; ++c) {
        const Vec3 q = leaf.texel(c, r);
        const double distance = n.dot(q) - side.offset;
        if (!(distance <= asked.found.limit())) continue;
        const Candidate met{
            q, -n, distance,
            feature_id(leaf.i + c, leaf.j + r, Where::corner, Part::face, side.index, asked.child)};
        const bool is_least = leaf.at(c - 1, r) + leaf.at(c + 1, r) - 2 * q.z() <= bend_x &&
                              leaf.at(c, r - 1) + leaf.at(c, r + 1) - 2 * q.z() <= bend_y &&
                              can_rest_on(leaf, c, r, n, slack_at(distance, asked.overlap));
        if (is_least) {
          if (inside(q, distance, [&](const Vec3& other) { return can_rest_on(leaf, c, r, other, slack); }))
            asked.found.add(met);
        } else if (distance < 0 && !asked.found.overlaps() &&
                   inside(q, distance, [](const Vec3&) { return false; })) {
          if (n.z() < under_side)
            asked.found.add_spare(met);
          else
            asked.found.add_witness(met);
        }
      }
    }
  };
  for_each_leaf(
      asked.surface, side.low - aside, side.high + aside,
      [&](const Piece& piece) {
        return piece.least({n.dot(piece.middle) - side.offset, n}) <= asked.found.limit();
      },
      visit);
}

}  // namespace intaglio::contact
