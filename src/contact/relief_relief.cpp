#include "contact/relief_relief.h"

#include <algorithm>
#include <array>

#include "contact/leaf_walk.h"
#include "contact/pairs.h"
#include "contact/query.h"
#include "surface/closest.h"

namespace intaglio::contact {

namespace {

// The local frame of one placement as the other's sees it.
Frame seen_from(const PosedSurface& one, const PosedSurface& other) {
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

// A corner of one relief and the nearest feature of the other.
struct CornerContact {
  int i, j;     // the corner's texel
  Vec3 corner;  // in the other's frame
  surface::Feature feature;
};

// The corners and creases of one relief that are within reach of the other.
class FeatureSearch {
 public:
  // `frame` takes points of `from` to the frame of `onto`.
  FeatureSearch(const surface::Surface& from, const surface::Surface& onto, const Frame& frame,
                double max_penetration, const Candidates& found)
      : from_(from), onto_(onto), frame_(frame), max_penetration_(max_penetration), found_(found) {}

  // Calls add(CornerContact) for every corner.
  template <class Add>
  void for_each_corner(const Add& add) const {
    visit_leaves([&](const Leaf& leaf) {
      for (int r = leaf.begin_r; r < leaf.end_r; ++r) {
        for (int c = leaf.begin_c; c < leaf.end_c; ++c) {
          if (leaf.is_convex(c, r)) corner(leaf, c, r, add);
        }
      }
    });
  }
  // Calls add(from, to, inward, index) for every crease; from, to and the directions of its flanks in the
  // other's frame.
  template <class Add>
  void for_each_crease(const Add& add) const {
    visit_leaves([&](const Leaf& leaf) {
      for (int r = leaf.begin_r; r < leaf.end_r; ++r) {
        for (int c = leaf.begin_c; c < leaf.end_c; ++c) {
          if (c < leaf.last_c) crease(leaf, c, r, 1, 0, add);
          if (r < leaf.last_r) crease(leaf, c, r, 0, 1, add);
        }
      }
    });
  }

 private:
  double reach() const { return std::max(found_.max_distance(), max_penetration_); }

  // Whether a piece may come within reach of the other relief: over the rectangle, and not far above or
  // below.
  bool may_reach(const SlabPiece& piece) const {
    const Vec3 middle = frame_(piece.middle);
    const double radius = 0.5 * (piece.side_x + piece.side_y).norm() +
                          0.5 * (piece.side_x - piece.side_y).norm() + piece.half_thickness;
    const double around = radius + reach();
    const Vec2 at = middle.head<2>();
    if (is_beside(onto_.placement(), at, at, around)) return false;
    const HeightRange range = range_around(onto_, at, around);
    return middle.z() <= range.high + around && middle.z() >= range.low - around;
  }

  template <class Visit>
  void visit_leaves(const Visit& visit) const {
    const surface::Placement& place = from_.placement();
    for_each_leaf(
        from_, Vec2::Zero(), Vec2(place.size_u(), place.size_v()),
        [this](const SlabPiece& piece) { return may_reach(piece); },
        [&](int i, int j) { visit(Leaf(from_, i, j)); });
  }

  // From texel (c, r) to (c + x, r + y), with the directions of its flanks half way along.
  template <class Add>
  void crease(const Leaf& leaf, int c, int r, int x, int y, const Add& add) const {
    const auto rise = [&](int side) {
      return 0.5 * (leaf.at(c + side * y, r + side * x) + leaf.at(c + x + side * y, r + y + side * x) -
                    leaf.at(c, r) - leaf.at(c + x, r + y));
    };
    const double across = x == 1 ? leaf.h : leaf.w;
    if (!(rise(-1) + rise(1) < -flat_bend * across)) return;
    const Vec3 from = frame_(leaf.texel(c, r)), to = frame_(leaf.texel(c + x, r + y)),
               along = (to - from).normalized();
    const Vec3 middle = 0.5 * (from + to);
    const double around = reach() + 0.5 * (to - from).norm();
    if (middle.z() > range_around(onto_, middle.head<2>(), around).high + around) return;
    const auto flank = [&](int side) {
      const Vec3 d = frame_.axes * Vec3(side * y * across, side * x * across, rise(side));
      return Vec3((d - d.dot(along) * along).normalized());
    };
    const std::array<Vec3, 2> inward = {flank(-1), flank(1)};
    // 181 is about sqrt(2^15): spreads (i, j) over the 16 bits that an id has; collisions are possible above
    // 181 columns.
    const int crease_index = 2 * (leaf.i + c + 181 * (leaf.j + r)) + y;
    add(from, to, inward, crease_index);
  }

  template <class Add>
  void corner(const Leaf& leaf, int c, int r, const Add& add) const {
    const Vec3 at = frame_(leaf.texel(c, r));
    const surface::Placement& place = onto_.placement();
    if (!place.covers(at)) return;
    const double gap = at.z() + onto_.depth(place.uv(at));
    const double max_distance = gap < 0 ? max_penetration_ : found_.max_distance();
    std::array<surface::Feature, 1> nearest;
    if (closest_features(onto_, at, max_distance, min_angle, nearest) == 0 || !place.covers(nearest[0].point))
      return;
    // The opposite of the other relief's normal must lie in the corner's normal cone.
    const Vec3 normal = frame_.axes.transpose() * -nearest[0].direction;
    if (!(normal.z() > 1e-3)) return;
    if (leaf.is_summit_along(c, r, normal, normal_slack_at(nearest[0].distance, max_penetration_)))
      add(CornerContact{leaf.i + c, leaf.j + r, at, nearest[0]});
  }

  const surface::Surface &from_, &onto_;
  const Frame& frame_;
  double max_penetration_;
  const Candidates& found_;
};

bool is_valid(const PosedSurface& one) {
  return is_rigid(one.pose) && one.surface.has_depth();
}

}  // namespace

ContactSet relief_relief_contacts(const PosedSurface& body, const PosedSurface& ground, double margin) {
  ContactSet set;
  if (!is_valid(body) || !is_valid(ground)) {
    set.status = is_rigid(body.pose) && is_rigid(ground.pose) ? status::no_size : status::bad_pose;
    return set;
  }
  const surface::Placement& place = ground.surface.placement();
  const double side = std::min(place.size_u(), place.size_v());
  set.status |= limit_margin(margin, side);
  const Frame body_to_ground = seen_from(body, ground), ground_to_body = seen_from(ground, body);
  if (is_far(body_to_ground.origin, side)) {
    set.status |= status::far;
    return set;
  }
  const double max_penetration = std::max({margin, ground.surface.texel_u(), ground.surface.texel_v(),
                                           body.surface.texel_u(), body.surface.texel_v()});
  Candidates found(margin);
  const FeatureSearch of_body(body.surface, ground.surface, body_to_ground, max_penetration, found),
      of_ground(ground.surface, body.surface, ground_to_body, max_penetration, found);
  of_body.for_each_corner([&](const CornerContact& contact) {
    found.add({contact.feature.point, contact.feature.direction, contact.feature.distance,
               feature_id(contact.i, contact.j, ReliefFeature::corner, BodyFeature::vertex, 0, 0)});
  });
  of_ground.for_each_corner([&](const CornerContact& contact) {
    found.add({body_to_ground(contact.corner), body_to_ground.axes * -contact.feature.direction,
               contact.feature.distance,
               feature_id(contact.i, contact.j, ReliefFeature::corner, BodyFeature::face, 0, 0)});
  });
  const PairQuery query{ground.surface, 0, max_penetration, found};
  of_body.for_each_crease([&](const Vec3& a, const Vec3& b, const std::array<Vec3, 2>& inward, int index) {
    edge_pairs(query, {a, b, inward, 0, index});
  });
  found.select(ground.surface, set);
  for (std::size_t k = 0; k < set.count; ++k) {
    ContactPoint& c = set.points[k];
    c.point = ground.pose.orientation.normalized() * c.point + ground.pose.position;
    c.normal = ground.pose.orientation.normalized() * c.normal;
    c.n_s = ground.pose.orientation.normalized() * c.n_s;
  }
  return set;
}

}  // namespace intaglio::contact
