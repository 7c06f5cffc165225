#include "contact/pairs.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "surface/closest.h"

namespace intaglio::contact {

namespace {

using surface::Feature;

// Independent of which adjacent cell the search reported.
std::uint64_t feature_at(const PairQuery& query, const Vec3& point, BodyFeature body, int index) {
  const GridPlace place =
      grid_place(point.x() / query.surface.texel_u() - 0.5, point.y() / query.surface.texel_v() - 0.5);
  const ReliefFeature relief = place.on_column
                                   ? (place.on_row ? ReliefFeature::corner : ReliefFeature::crease_y)
                                   : (place.on_row ? ReliefFeature::crease_x : ReliefFeature::patch);
  return feature_id(int(place.i), int(place.j), relief, body, index, query.part);
}

void add_all(const PairQuery& query, std::span<const Feature> features, std::span<const Vec3> edges,
             double radius, BodyFeature body, int index) {
  for (const Feature& f : features) {
    // Outside the rectangle, though the texture continues.
    if (!query.surface.placement().covers(f.point)) continue;
    const Candidate candidate{f.point, f.direction, f.distance - radius,
                              feature_at(query, f.point, body, index)};
    if (is_in_corner_cone(f.direction, edges)) {
      query.found.add(candidate);
    } else if (f.distance < 0) {
      query.found.add_fallback(candidate);
    }
  }
}

}  // namespace

bool is_in_corner_cone(const Vec3& direction, std::span<const Vec3> edges) {
  return std::all_of(edges.begin(), edges.end(),
                     [&](const Vec3& edge) { return direction.dot(edge) >= -corner_slack; });
}

void sphere_pairs(const PairQuery& query, const Vec3& centre, double radius, int index) {
  std::array<Feature, ContactSet::capacity> features;
  const std::size_t count =
      closest_features(query.surface, centre, radius + query.found.max_distance(), min_angle, features);
  add_all(query, std::span(features).first(count), {}, radius, BodyFeature::smooth, index);
}

void corner_pairs(const PairQuery& query, const Vec3& corner, std::span<const Vec3> edges, double radius,
                  int index) {
  const double reach = radius + query.found.max_distance();
  if (corner.z() > reach) return;
  const surface::Placement& place = query.surface.placement();
  const Vec2 plan = corner.head<2>();
  if (is_beside(place, plan, plan, reach)) return;
  const double gap = corner.z() + query.surface.depth(place.uv(corner));
  if (gap > 0 || radius > 0) {
    std::array<Feature, 4> features;
    const std::size_t count = closest_features(query.surface, corner, reach, min_angle, features);
    add_all(query, std::span(features).first(count), edges, radius, BodyFeature::vertex, index);
  } else if (const auto nearest = closest_point(query.surface, corner)) {
    add_all(query, std::span(&*nearest, 1), edges, radius, BodyFeature::vertex, index);
  }
}

bool is_plausible_exit(const surface::Surface& surface, const Vec3& p, double distance) {
  constexpr double max_depth_ratio = 1.5;
  const double depth_below = -surface.depth(surface.placement().uv(p)) - p.z();
  return -distance <= max_depth_ratio * depth_below + 1e-9;
}

void add_edge_contact(const PairQuery& query, const Leaf& leaf, int index, const EdgeContact& contact) {
  const double distance = contact.distance;
  if (distance < -query.max_penetration || !query.surface.placement().covers(contact.point)) return;
  if (contact.radius == 0 && distance < 0 && !is_plausible_exit(query.surface, contact.on_edge, distance))
    return;
  const Candidate candidate{contact.point, contact.normal, distance - contact.radius,
                            feature_id(leaf.i + contact.c, leaf.j + contact.r, contact.feature,
                                       BodyFeature::edge, index, query.part)};
  if (contact.is_minimum && contact.lean <= normal_slack_at(distance, query.max_penetration)) {
    query.found.add(candidate);
  } else if (candidate.distance < 0) {
    query.found.add_fallback(candidate);
  }
}

void add_crossing(const PairQuery& query, const Leaf& leaf, int c, int r, int x, int index, const Vec3& p,
                  double z) {
  const double gap = p.z() - z;
  if (gap >= 0) return;
  const Vec3 on_relief = p - gap * Vec3::UnitZ();
  if (!query.surface.placement().covers(on_relief)) return;
  query.found.add_last_resort(
      {on_relief, Vec3::UnitZ(), gap,
       feature_id(leaf.i + c, leaf.j + r, x == 1 ? ReliefFeature::crease_x : ReliefFeature::crease_y,
                  BodyFeature::edge, index, query.part)});
}

// A straight edge against corners, creases and patches of the relief.

namespace {

class EdgeSearch {
 public:
  EdgeSearch(const PairQuery& query, const StraightEdge& edge)
      : query_(query),
        edge_(edge),
        along_(edge.b - edge.a),
        inverse_(1 / along_.x(), 1 / along_.y()),
        length2_(along_.squaredNorm()),
        bounds_(edge.a, edge.b, edge.radius + query.found.max_distance(), query.max_penetration) {}

  void run() {
    if (!(length2_ > 0) || std::min(edge_.a.z(), edge_.b.z()) > bounds_.reach()) return;
    for_each_leaf(
        query_.surface, bounds_.low(), bounds_.high(),
        [this](const SlabPiece& piece) { return bounds_.may_contain_contact(piece); },
        [this](int i, int j) {
          const Leaf leaf(query_.surface, i, j);
          visit_features(*this, leaf, mask_near(leaf, bounds_));
        });
  }

  void corner(const Leaf& leaf, int c, int r) const {
    const Vec3 q = leaf.texel(c, r), offset = q - edge_.a;
    const double u = along_.dot(offset);
    if (u <= 0 || u >= length2_) return;
    const Vec3 difference = u / length2_ * along_ - offset;
    const double d2 = difference.squaredNorm();
    // On the edge itself the direction is undefined; the crease tests cover it.
    if (d2 > bounds_.reach() * bounds_.reach() || d2 < 1e-18 || difference.z() == 0) return;
    const double slope_x = -difference.x() / difference.z(), slope_y = -difference.y() / difference.z();
    // Relief corners inside a polyhedron are handled by its faces.
    if (difference.z() < 0 && edge_.radius == 0) return;
    const bool is_summit = leaf.is_summit(c, r, slope_x, slope_y, 0, 0);
    if (!is_summit && edge_.radius == 0) return;
    const double d = std::copysign(std::sqrt(d2), difference.z());
    add({leaf, c, r, ReliefFeature::corner}, q, difference / d, d, is_summit);
  }

  // From texel (c, r) to (c + x, r + y).
  void crease(const Leaf& leaf, int c, int r, int x, int y) const {
    if (!query_.found.overlaps()) look_under(leaf, c, r, x, y);
    const double z = leaf.at(c, r), rise = leaf.at(c + x, r + y) - z;
    const double slope_along = rise / (x == 1 ? leaf.w : leaf.h);
    // Slope across the crease of the plane spanned by edge and crease.
    const int axis = 1 - x;
    const double slope_across = (along_.z() - along_[axis] * slope_along) / along_[1 - axis];
    const CreaseSlopes first{z - leaf.at(c - y, r - x), leaf.at(c + y, r + x) - z},
        second{leaf.at(c + x, r + y) - leaf.at(c + x - y, r + y - x),
               leaf.at(c + x + y, r + y + x) - leaf.at(c + x, r + y)};
    const Crease it{leaf,
                    c,
                    r,
                    x == 1 ? ReliefFeature::crease_x : ReliefFeature::crease_y,
                    Vec3(x * leaf.w, y * leaf.h, rise),
                    slope_across,
                    x == 1 ? leaf.h : leaf.w,
                    first,
                    second};
    const CreaseSlopes widest{std::max(first.behind, second.behind), std::min(first.ahead, second.ahead)};
    if (is_ridge(it, widest) &&
        (x == 1 ? is_outward(slope_along, slope_across) : is_outward(slope_across, slope_along)))
      add_common_normal(it);
  }

  // The inside of a patch, where its normal is square to the edge and points at it.
  //
  // With the rises a, b and the twist k the patch is
  //   q(s, t) = q0 + (s w, t h, s a + t b + s t k),   0 <= s, t <= 1,
  // and its upward normal q_s x q_t / (w h) is
  //   m(s, t) = (-(a + t k) / w, -(b + s k) / h, 1).
  // A common normal of patch and edge (direction e, through A) needs two things.
  //   1. It is square to the edge: e . m = g + g_s s + g_t t = 0, with g = e_z - a e_x/w - b e_y/h,
  //      g_s = -k e_y/h, g_t = -k e_x/w. That is linear: (s, t) is on a straight line. It is parametrised by
  //      the coordinate that changes faster along it, and cut to the unit square.
  //   2. The line from q along m meets the edge's: V = det[q - A, e, m] = 0. On the straight line V has one
  //      variable; where its signs at the ends differ, there is a root between them.
  // Over the plan direction of the edge the height of the patch has the second derivative
  // 2 k (e_x/w)(e_y/h). The gap below a straight edge is a minimum along it only if that is negative: the
  // patch bends down. For an axis with a radius the sign does not decide, because the patch may curve away
  // within that radius; both signs are accepted, since a pair that is no minimum is never the deepest.
  void patch(const Leaf& leaf, int c, int r) const {
    const double z = leaf.at(c, r), a = leaf.at(c + 1, r) - z, b = leaf.at(c, r + 1) - z,
                 twist = leaf.at(c + 1, r + 1) - z - a - b;
    const double ex = along_.x() / leaf.w, ey = along_.y() / leaf.h;
    if (!(edge_.radius > 0 ? twist * ex * ey != 0 : twist * ex * ey < 0)) return;
    const double g = along_.z() - a * ex - b * ey, g_s = -twist * ey, g_t = -twist * ex;
    const double low = g + std::min(g_s, 0.0) + std::min(g_t, 0.0),
                 high = g + std::max(g_s, 0.0) + std::max(g_t, 0.0);
    if (!(low < 0 && high > 0)) return;
    const Vec3 first = leaf.texel(c, r) - edge_.a;
    const bool by_t = std::abs(g_s) > std::abs(g_t);
    // The interval of the free coordinate that keeps the other within 0..1.
    const double slope = by_t ? -g_t / g_s : -g_s / g_t, start = by_t ? -g / g_s : -g / g_t;
    double from = 0, to = 1;
    if (slope != 0) {
      const double x = -start / slope, y = (1 - start) / slope;
      from = std::max(from, std::min(x, y));
      to = std::min(to, std::max(x, y));
    }
    if (!(from < to)) return;
    Vec3 q, normal;
    const auto volume = [&](double free) {
      const double s = by_t ? start + slope * free : free, t = by_t ? free : start + slope * free;
      q = first + Vec3(s * leaf.w, t * leaf.h, s * a + t * b + s * t * twist);
      normal = Vec3(-(a + t * twist) / leaf.w, -(b + s * twist) / leaf.h, 1);
      return q.dot(along_.cross(normal));
    };
    const double f_from = volume(from), f_to = volume(to);
    if ((f_from < 0) == (f_to < 0)) return;
    volume(find_root(volume, from, to, f_from, f_to, 1e-12));
    normal.normalize();
    const double gap = -q.dot(normal), u = along_.dot(q + gap * normal) / length2_;
    if (u > 0 && u < 1) add({leaf, c, r, ReliefFeature::patch}, edge_.a + q, normal, gap);
  }

 private:
  // Rise over the cell behind and over the cell ahead of a crease, at one of its ends.
  struct CreaseSlopes {
    double behind, ahead;
  };
  struct Crease {
    const Leaf& leaf;
    int c, r;
    ReliefFeature feature;
    Vec3 along;
    double slope, size;  // across it: of the plane that holds the edge, too; and of a cell
    CreaseSlopes first, second;
  };
  struct ReliefPlace {
    const Leaf& leaf;
    int c, r;
    ReliefFeature feature;
  };

  void look_under(const Leaf& leaf, int c, int r, int x, int y) const {
    const Vec3 q = leaf.texel(c, r);
    const double u = x == 1 ? (q.y() - edge_.a.y()) * inverse_.y() : (q.x() - edge_.a.x()) * inverse_.x();
    if (!(u >= 0 && u <= 1) || edge_.radius > 0) return;
    const double t = x == 1 ? (edge_.a.x() + u * along_.x() - q.x()) / leaf.w
                            : (edge_.a.y() + u * along_.y() - q.y()) / leaf.h;
    if (!(t >= 0 && t <= 1)) return;
    add_crossing(query_, leaf, c, r, x, edge_.index, edge_.a + u * along_,
                 leaf.at(c, r) + t * (leaf.at(c + x, r + y) - leaf.at(c, r)));
  }

  // Whether the crease is convex and its slope across lies between those of its two flanks. False, too, where
  // edge and crease are parallel: the slope is infinite or NaN.
  bool is_ridge(const Crease& crease, const CreaseSlopes& flanks, double angle = normal_slack) const {
    const double slope = crease.slope, size = crease.size;
    const double slack = edge_.radius > 0 ? 0 : slope_slack(angle, slope * slope) * size;
    return flanks.behind - flanks.ahead > flat_bend * size && slope * size <= flanks.behind + slack &&
           slope * size >= flanks.ahead - slack;
  }
  // Whether the opposite of the relief's normal at these slopes lies in the edge's normal cone.
  bool is_outward(double slope_x, double slope_y) const {
    const Vec3 upward(-slope_x, -slope_y, 1);
    return std::all_of(edge_.inward.begin(), edge_.inward.end(), [&](const Vec3& inward) {
      const double sine = upward.dot(inward);
      return sine >= 0 || sine * sine <= normal_slack * normal_slack * upward.squaredNorm();
    });
  }
  // The common perpendicular, pointing up, where it meets both edge and crease between their ends.
  void add_common_normal(const Crease& crease) const {
    const Vec3 up = along_.cross(crease.along);
    const double norm2 = up.squaredNorm();
    if (!(up.z() * up.z() > 1e-12 * norm2) || norm2 < 1e-20 * length2_ * crease.along.squaredNorm()) return;
    const Vec3 q = crease.leaf.texel(crease.c, crease.r), offset = q - edge_.a;
    const double u = offset.cross(crease.along).dot(up) / norm2, t = offset.cross(along_).dot(up) / norm2;
    if (!(u >= 0 && u <= 1 && t >= 0 && t <= 1)) return;
    const CreaseSlopes &first = crease.first, &second = crease.second;
    const CreaseSlopes flanks{first.behind + t * (second.behind - first.behind),
                              first.ahead + t * (second.ahead - first.ahead)};
    const Vec3 normal = std::copysign(1 / std::sqrt(norm2), up.z()) * up, on = q + t * crease.along;
    const double distance = (edge_.a + u * along_ - on).dot(normal);
    if (!is_ridge(crease, flanks)) return;
    const bool is_minimum = is_ridge(crease, flanks, normal_slack_at(distance, query_.max_penetration));
    add({crease.leaf, crease.c, crease.r, crease.feature}, on, normal, distance, is_minimum);
  }

  void add(const ReliefPlace& place, const Vec3& q, const Vec3& normal, double distance,
           bool is_minimum = true) const {
    double lean = 0;
    for (const Vec3& inward : edge_.inward) lean = std::max(lean, -normal.dot(inward));
    if (lean > normal_slack) return;
    add_edge_contact(query_, place.leaf, edge_.index,
                     {place.feature, place.c, place.r, q, normal, q + distance * normal, distance,
                      edge_.radius, lean, is_minimum});
  }

  const PairQuery& query_;
  const StraightEdge& edge_;
  Vec3 along_;
  Vec2 inverse_;  // componentwise inverse of along_; may be infinite
  double length2_;
  EdgeBounds bounds_;
};

}  // namespace

void edge_pairs(const PairQuery& query, const StraightEdge& edge) {
  EdgeSearch(query, edge).run();
}

}  // namespace intaglio::contact
