#include "contact/relief_relief.h"

#include <algorithm>

#include "contact/leaf_walk.h"
#include "contact/pairs.h"
#include "contact/query.h"
#include "surface/closest.h"

namespace intaglio::contact {

namespace {

// The local frame of one placement as the other's sees it.
Frame seen_from(const PlacedSurface& one, const PlacedSurface& other) {
  const auto axis = [&](int k) {
    const Vec3 world =
        one.pose.orientation.normalized() * one.surface.placement().direction_to_world(Vec3::Unit(k));
    return other.surface.placement().direction_to_local(other.pose.orientation.normalized().conjugate() *
                                                        world);
  };
  Frame frame;
  for (int k = 0; k < 3; ++k) frame.axes.col(k) = axis(k);
  const Vec3 corner =
      one.pose.orientation.normalized() * one.surface.placement().to_world(Vec3::Zero()) + one.pose.position;
  frame.origin = other.surface.placement().to_local(other.pose.orientation.normalized().conjugate() *
                                                    (corner - other.pose.position));
  return frame;
}

// Of a corner: where the other relief is nearest.
struct Met {
  int i, j;     // the corner's texel
  Vec3 corner;  // frame of the other
  surface::Feature feature;
};

class CornerSearch {
 public:
  // `frame` takes points of `from` to the frame of `onto`.
  CornerSearch(const surface::Surface& from, const surface::Surface& onto, const Frame& frame, double overlap,
               Candidates& found)
      : from_(from), onto_(onto), frame_(frame), overlap_(overlap), found_(found) {}

  // Calls add(Met) for every corner that is within reach.
  template <class Add>
  void run(const Add& add) const {
    walk([&](const Leaf& leaf) { visit(leaf, add); });
  }
  // Calls ask(a, b, inward, i, j, along x or y) for every crease that may be within reach.
  template <class Ask>
  void run_creases(const Ask& ask) const {
    walk([&](const Leaf& leaf) {
      for (int r = leaf.begin_r; r < leaf.end_r; ++r) {
        for (int c = leaf.begin_c; c < leaf.end_c; ++c) {
          if (c < leaf.last_c) crease(leaf, c, r, 1, 0, ask);
          if (r < leaf.last_r) crease(leaf, c, r, 0, 1, ask);
        }
      }
    });
  }

 private:
  // Whether a piece may come within reach of the other relief: over the rectangle, and not far above or
  // below.
  bool wanted(const Piece& piece) const {
    const Vec3 middle = frame_(piece.middle);
    const double radius =
        0.5 * (piece.side_x + piece.side_y).norm() + 0.5 * (piece.side_x - piece.side_y).norm() + piece.play;
    const double reach = radius + std::max(found_.limit(), overlap_);
    const surface::Placement& place = onto_.placement();
    if (middle.x() < -reach || middle.y() < -reach || middle.x() > place.size_u() + reach ||
        middle.y() > place.size_v() + reach)
      return false;
    const Vec2 at = middle.head<2>(), aside = Vec2::Constant(reach);
    const HeightRange range = range_over(onto_, at - aside, at + aside);
    return middle.z() <= range.high + reach && middle.z() >= range.low - reach;
  }

  template <class Visit>
  void walk(const Visit& visit_leaf) const {
    const surface::Placement& place = from_.placement();
    for_each_leaf(
        from_, Vec2::Zero(), Vec2(place.size_u(), place.size_v()),
        [this](const Piece& piece) { return wanted(piece); },
        [&](int i, int j) { visit_leaf(Leaf(from_, i, j)); });
  }

  // From texel (c, r) to (c + x, r + y), with the directions of its flanks half way along.
  template <class Ask>
  void crease(const Leaf& leaf, int c, int r, int x, int y, const Ask& ask) const {
    const auto rise = [&](int side) {
      return 0.5 * (leaf.at(c + side * y, r + side * x) + leaf.at(c + x + side * y, r + y + side * x) -
                    leaf.at(c, r) - leaf.at(c + x, r + y));
    };
    const double across = x == 1 ? leaf.h : leaf.w;
    if (!(rise(-1) + rise(1) < -flat_bend * across)) return;
    const Vec3 from = frame_(leaf.texel(c, r)), to = frame_(leaf.texel(c + x, r + y)),
               along = (to - from).normalized();
    const Vec3 middle = 0.5 * (from + to);
    const double reach = std::max(found_.limit(), overlap_) + 0.5 * (to - from).norm();
    const Vec2 at = middle.head<2>(), aside = Vec2::Constant(reach);
    if (middle.z() > range_over(onto_, at - aside, at + aside).high + reach) return;
    const auto flank = [&](int side) {
      const Vec3 d = frame_.axes * Vec3(side * y * across, side * x * across, rise(side));
      return Vec3((d - d.dot(along) * along).normalized());
    };
    const std::array<Vec3, 2> inward = {flank(-1), flank(1)};
    ask(from, to, inward, leaf.i + c, leaf.j + r, y);
  }

  template <class Add>
  void visit(const Leaf& leaf, const Add& add) const {
    for (int r = leaf.begin_r; r < leaf.end_r; ++r) {
      for (int c = leaf.begin_c; c < leaf.end_c; ++c) {
        const double z = 2 * leaf.at(c, r);
        if (leaf.at(c - 1, r) + leaf.at(c + 1, r) - z > -flat_bend * leaf.w ||
            leaf.at(c, r - 1) + leaf.at(c, r + 1) - z > -flat_bend * leaf.h)
          continue;
        corner(leaf, c, r, add);
      }
    }
  }

  template <class Add>
  void corner(const Leaf& leaf, int c, int r, const Add& add) const {
    const Vec3 at = frame_(leaf.texel(c, r));
    const surface::Placement& place = onto_.placement();
    if (!place.covers(at)) return;
    const double gap = at.z() + onto_.depth(place.uv(at));
    const double reach = gap < 0 ? overlap_ : found_.limit();
    std::array<surface::Feature, 1> nearest;
    if (closest_features(onto_, at, reach, min_angle, nearest) == 0 || !place.covers(nearest[0].point))
      return;
    // The corner's own normals must hold the other's, turned round.
    const Vec3 normal = frame_.axes.transpose() * -nearest[0].direction;
    if (!(normal.z() > 1e-3)) return;
    const double x = -normal.x() / normal.z(), y = -normal.y() / normal.z();
    const double angle = slack_at(nearest[0].distance, overlap_);
    if (leaf.is_summit(c, r, x, y, slope_slack(angle, x * x), slope_slack(angle, y * y)))
      add(Met{leaf.i + c, leaf.j + r, at, nearest[0]});
  }

  const surface::Surface &from_, &onto_;
  const Frame& frame_;
  double overlap_;
  Candidates& found_;
};

bool is_askable(const PlacedSurface& one) {
  return is_rigid(one.pose) && one.surface.has_depth();
}

}  // namespace

ContactSet relief_relief_contacts(const PlacedSurface& body, const PlacedSurface& ground, double margin) {
  ContactSet set;
  if (!is_askable(body) || !is_askable(ground)) {
    set.status = is_rigid(body.pose) && is_rigid(ground.pose) ? status::no_size : status::bad_pose;
    return set;
  }
  const surface::Placement& place = ground.surface.placement();
  const double side = std::min(place.size_u(), place.size_v());
  if (!(margin <= side)) set.status |= status::wide_margin;
  margin = margin > 0 ? std::min(margin, side) : 0;
  const Frame there = seen_from(body, ground), back = seen_from(ground, body);
  if (there.origin.norm() > 1e5 * side) {
    set.status |= status::far;
    return set;
  }
  const double overlap = std::max({margin, ground.surface.texel_u(), ground.surface.texel_v(),
                                   body.surface.texel_u(), body.surface.texel_v()});
  Candidates found(margin);
  CornerSearch(body.surface, ground.surface, there, overlap, found).run([&](const Met& met) {
    found.add({met.feature.point, met.feature.direction, met.feature.distance,
               feature_id(met.i, met.j, Where::corner, Part::vertex, 0, 0)});
  });
  CornerSearch(ground.surface, body.surface, back, overlap, found).run([&](const Met& met) {
    found.add({there(met.corner), there.axes * -met.feature.direction, met.feature.distance,
               feature_id(met.i, met.j, Where::corner, Part::face, 0, 0)});
  });
  const Asked asked{ground.surface, 0, overlap, found};
  CornerSearch(body.surface, ground.surface, there, overlap, found)
      .run_creases(
          [&](const Vec3& a, const Vec3& b, const std::array<Vec3, 2>& inward, int i, int j, int along) {
            edge_pairs(asked, {a, b, inward, 0, 2 * (i + 181 * j) + along});
          });
  if (found.overflowed()) set.status |= status::limit;
  found.choose(ground.surface, set);
  for (std::size_t k = 0; k < set.count; ++k) {
    ContactPoint& c = set.points[k];
    c.point = ground.pose.orientation.normalized() * c.point + ground.pose.position;
    c.normal = ground.pose.orientation.normalized() * c.normal;
    c.n_s = ground.pose.orientation.normalized() * c.n_s;
  }
  return set;
}

}  // namespace intaglio::contact
