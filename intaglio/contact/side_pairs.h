// A flat side of the body against the corners of the relief. Internal to contact/.
#pragma once

#include "intaglio/contact/leaf_walk.h"
#include "intaglio/contact/pairs.h"
#include "intaglio/contact/slack.h"

namespace intaglio::contact {

struct Side {
  Vec3 normal;  // unit, outwards, down
  double offset;
  Vec2 low, high;  // of its corners, in plan
  int index;
};

// inside(q, distance) says whether a corner of the relief at that distance from the plane counts.
template <class Inside>
void side_pairs(const Asked& asked, const Side& side, const Inside& inside) {
  const Vec3& n = side.normal;
  const double slope_x = -n.x() / n.z(), slope_y = -n.y() / n.z();
  const Vec2 aside = Vec2::Constant(std::max(asked.found.limit(), asked.overlap));
  const auto is_summit = [&](const Leaf& leaf, int c, int r, double angle) {
    return leaf.is_summit(c, r, slope_x, slope_y, slope_slack(angle, slope_x * slope_x),
                          slope_slack(angle, slope_y * slope_y));
  };
  const auto visit = [&](int i, int j) {
    const Leaf leaf(asked.surface, i, j);
    const double bend_x = -flat_bend * leaf.w, bend_y = -flat_bend * leaf.h;
    for (int r = leaf.begin_r; r < leaf.end_r; ++r) {
      for (int c = leaf.begin_c; c < leaf.end_c; ++c) {
        const Vec3 q = leaf.texel(c, r);
        const double distance = n.dot(q) - side.offset;
        if (!(distance <= asked.found.limit()) ||
            leaf.at(c - 1, r) + leaf.at(c + 1, r) - 2 * q.z() > bend_x ||
            leaf.at(c, r - 1) + leaf.at(c, r + 1) - 2 * q.z() > bend_y ||
            !is_summit(leaf, c, r, slack_at(distance, asked.overlap)) || !inside(q, distance))
          continue;
        asked.found.add(
            {q, -n, distance,
             feature_id(leaf.i + c, leaf.j + r, Where::corner, Part::face, side.index, asked.child)});
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
