#include "contact/pairs.h"

#include <algorithm>
#include <cmath>

#include "contact/leaf_walk.h"
#include "surface/closest.h"

namespace intaglio::contact {

namespace {

using surface::Feature;

// Which of the cells that meet there the search found does not matter to the name.
std::uint64_t name_of(const surface::Surface& surface, const Vec3& point, Part part, int index, int child) {
  constexpr double near = 1e-6;
  const double x = point.x() / surface.texel_u() - 0.5, y = point.y() / surface.texel_v() - 0.5;
  const double i = std::floor(x + near), j = std::floor(y + near);
  const bool on_column = x - i < near, on_row = y - j < near;
  const Where where =
      on_column ? (on_row ? Where::corner : Where::crease_y) : (on_row ? Where::crease_x : Where::patch);
  return feature_id(static_cast<int>(i), static_cast<int>(j), where, part, index, child);
}

void add_all(const Asked& asked, std::span<const Feature> features, std::span<const Vec3> around,
             double radius, Part part, int index) {
  for (const Feature& f : features) {
    if (!asked.surface.placement().covers(f.point)) continue;  // the texture goes on, the rectangle does not
    const bool is_least = std::all_of(around.begin(), around.end(), [&](const Vec3& edge) {
      return f.direction.dot(edge) >= -corner_slack;
    });
    const Candidate candidate{f.point, f.direction, f.distance - radius,
                              name_of(asked.surface, f.point, part, index, asked.child)};
    if (is_least) {
      asked.found.add(candidate);
    } else if (f.distance < 0) {
      asked.found.add_spare(candidate);
    }
  }
}

}  // namespace

void ball_pairs(const Asked& asked, const Vec3& centre, double radius, int index) {
  std::array<Feature, ContactSet::capacity> features;
  const std::size_t count =
      closest_features(asked.surface, centre, radius + asked.found.limit(), min_angle, features);
  add_all(asked, std::span(features).first(count), {}, radius, Part::round, index);
}

void corner_pairs(const Asked& asked, const Vec3& corner, std::span<const Vec3> around, double radius,
                  int index) {
  const double limit = radius + asked.found.limit();
  if (corner.z() > limit) return;
  const surface::Placement& place = asked.surface.placement();
  if (corner.x() < -limit || corner.y() < -limit || corner.x() > place.size_u() + limit ||
      corner.y() > place.size_v() + limit)
    return;
  const double gap = corner.z() + asked.surface.depth(place.uv(corner));
  if (gap > 0 || radius > 0) {
    std::array<Feature, 4> features;
    const std::size_t count = closest_features(asked.surface, corner, limit, min_angle, features);
    add_all(asked, std::span(features).first(count), around, radius, Part::vertex, index);
  } else if (const auto nearest = closest_point(asked.surface, corner)) {
    add_all(asked, std::span(&*nearest, 1), around, radius, Part::vertex, index);
  }
}

// An edge of the body against corners, creases and patches of the relief.

namespace {

class EdgeSearch {
 public:
  EdgeSearch(const Asked& asked, const StraightEdge& edge)
      : asked_(asked),
        edge_(edge),
        along_(edge.b - edge.a),
        inverse_(1 / along_.x(), 1 / along_.y()),
        length2_(along_.squaredNorm()),
        rod_(edge.a, edge.b, edge.radius + asked.found.limit(), asked.overlap) {}

  void run() {
    if (!(length2_ > 0) || std::min(edge_.a.z(), edge_.b.z()) > rod_.reach()) return;
    for_each_leaf(
        asked_.surface, rod_.low(), rod_.high(), [this](const Piece& piece) { return rod_.may_meet(piece); },
        [this](int i, int j) {
          const Leaf leaf(asked_.surface, i, j);
          search_leaf(*this, leaf, texels_up(leaf, rod_));
        });
  }

  void corner(const Leaf& leaf, int c, int r) const {
    const Vec3 q = leaf.texel(c, r), away = q - edge_.a;
    const double u = along_.dot(away);
    if (u <= 0 || u >= length2_) return;
    const Vec3 apart = u / length2_ * along_ - away;
    const double d2 = apart.squaredNorm();
    // On the edge itself there is no direction; creases find that.
    if (d2 > rod_.reach() * rod_.reach() || d2 < 1e-18 || apart.z() == 0) return;
    const double slope_x = -apart.x() / apart.z(), slope_y = -apart.y() / apart.z();
    // Inside of a polyhedron the faces answer for it.
    if (apart.z() < 0 && edge_.radius == 0) return;
    const bool is_summit = leaf.is_summit(c, r, slope_x, slope_y, 0, 0);
    if (!is_summit && edge_.radius == 0) return;
    const double d = std::copysign(std::sqrt(d2), apart.z());
    report(leaf, c, r, Where::corner, q, apart / d, d, is_summit);
  }

  // From texel (c, r) to the next along x.
  void crease_x(const Leaf& leaf, int c, int r) const {
    const double z = leaf.at(c, r), slope_x = (leaf.at(c + 1, r) - z) / leaf.w;
    if (!asked_.found.overlaps()) look_under(leaf, c, r, 1, 0);
    // Of the plane that holds both directions.
    const double slope_y = (along_.z() - along_.x() * slope_x) / along_.y();
    const Across first{z - leaf.at(c, r - 1), leaf.at(c, r + 1) - z},
        second{leaf.at(c + 1, r) - leaf.at(c + 1, r - 1), leaf.at(c + 1, r + 1) - leaf.at(c + 1, r)};
    if (is_ridge(first, second, slope_y, leaf.h) && is_outward(slope_x, slope_y))
      cross(leaf, c, r, Vec3(leaf.w, 0, leaf.at(c + 1, r) - z), first, second, slope_y, leaf.h);
  }
  void crease_y(const Leaf& leaf, int c, int r) const {
    const double z = leaf.at(c, r), slope_y = (leaf.at(c, r + 1) - z) / leaf.h;
    if (!asked_.found.overlaps()) look_under(leaf, c, r, 0, 1);
    const double slope_x = (along_.z() - along_.y() * slope_y) / along_.x();
    const Across first{z - leaf.at(c - 1, r), leaf.at(c + 1, r) - z},
        second{leaf.at(c, r + 1) - leaf.at(c - 1, r + 1), leaf.at(c + 1, r + 1) - leaf.at(c, r + 1)};
    if (is_ridge(first, second, slope_x, leaf.w) && is_outward(slope_x, slope_y))
      cross(leaf, c, r, Vec3(0, leaf.h, leaf.at(c, r + 1) - z), first, second, slope_x, leaf.w);
  }

  // The inside of a patch: where its normal is square to the edge and points at it. Square it is on a
  // straight line of (s, t); along that, the sign of the volume of edge, normal and what is between them
  // changes.
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
    // Which stretch of the free coordinate keeps the other within 0..1.
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
    double f_from = volume(from), f_to = volume(to);
    if ((f_from < 0) == (f_to < 0)) return;
    for (int round = 0; round < 60 && std::abs(to - from) > 1e-12; ++round) {  // regula falsi, Illinois
      const double at = to - f_to * (to - from) / (f_to - f_from);
      const double f = volume(at);
      if (f == 0) break;
      if ((f < 0) == (f_to < 0)) {
        f_from *= 0.5;
      } else {
        from = to;
        f_from = f_to;
      }
      if (std::abs(at - to) < 1e-13) break;
      to = at;
      f_to = f;
    }
    normal.normalize();
    const double gap = -q.dot(normal), u = along_.dot(q + gap * normal) / length2_;
    if (u > 0 && u < 1) report(leaf, c, r, Where::patch, edge_.a + q, normal, gap);
  }

 private:
  // Where the edge crosses the crease from texel (c, r) to (c + x, r + y) in plan, an edge below shows an
  // overlap: a crease in the body is above the edge of two of its faces somewhere, if neither of its ends is
  // in the body.
  void look_under(const Leaf& leaf, int c, int r, int x, int y) const {
    const Vec3 q = leaf.texel(c, r);
    const double u = x == 1 ? (q.y() - edge_.a.y()) * inverse_.y() : (q.x() - edge_.a.x()) * inverse_.x();
    if (!(u >= 0 && u <= 1) || edge_.radius > 0) return;
    const double t = x == 1 ? (edge_.a.x() + u * along_.x() - q.x()) / leaf.w
                            : (edge_.a.y() + u * along_.y() - q.y()) / leaf.h;
    if (!(t >= 0 && t <= 1)) return;
    const double z = leaf.at(c, r) + t * (leaf.at(c + x, r + y) - leaf.at(c, r)),
                 gap = edge_.a.z() + u * along_.z() - z;
    if (gap >= 0) return;
    const Vec3 on = edge_.a + u * along_ - gap * Vec3::UnitZ();
    if (!asked_.surface.placement().covers(on)) return;
    asked_.found.add_witness({on, Vec3::UnitZ(), gap,
                              feature_id(leaf.i + c, leaf.j + r, x == 1 ? Where::crease_x : Where::crease_y,
                                         Part::edge, edge_.index, asked_.child)});
  }

  // How the relief rises across a crease at one of its ends, from behind and ahead, a cell each.
  struct Across {
    double behind, ahead;
  };

  // Whether a crease may point up and hold a slope across it, somewhere between its ends. False, too, where
  // edge and crease are parallel: the slope is infinite or no number.
  bool is_ridge(const Across& a, const Across& b, double slope, double size, double angle = slack) const {
    const double behind = std::max(a.behind, b.behind), ahead = std::min(a.ahead, b.ahead);
    const double more = edge_.radius > 0 ? 0 : slope_slack(angle, slope * slope) * size;
    return behind - ahead > flat_bend * size && slope * size <= behind + more && slope * size >= ahead - more;
  }
  // Whether the body's normals at the edge hold the relief's normal of these slopes, turned round.
  bool is_outward(double slope_x, double slope_y) const {
    const Vec3 upward(-slope_x, -slope_y, 1);
    return std::all_of(edge_.inward.begin(), edge_.inward.end(), [&](const Vec3& inward) {
      const double sine = upward.dot(inward);
      return sine >= 0 || sine * sine <= slack * slack * upward.squaredNorm();
    });
  }
  // The common perpendicular, pointing up, where both lines are within their ends.
  void cross(const Leaf& leaf, int c, int r, const Vec3& crease, const Across& first, const Across& second,
             double slope, double size) const {
    const Vec3 turned = along_.cross(crease);
    const double norm2 = turned.squaredNorm();
    if (!(turned.z() * turned.z() > 1e-12 * norm2) || norm2 < 1e-20 * length2_ * crease.squaredNorm()) return;
    const Vec3 q = leaf.texel(c, r), away = q - edge_.a;
    const double u = away.cross(crease).dot(turned) / norm2, t = away.cross(along_).dot(turned) / norm2;
    if (!(u >= 0 && u <= 1 && t >= 0 && t <= 1)) return;
    const Across there{first.behind + t * (second.behind - first.behind),
                       first.ahead + t * (second.ahead - first.ahead)};
    const Vec3 normal = std::copysign(1 / std::sqrt(norm2), turned.z()) * turned, on = q + t * crease;
    const double distance = (edge_.a + u * along_ - on).dot(normal);
    if (!is_ridge(there, there, slope, size)) return;
    const bool is_least = is_ridge(there, there, slope, size, slack_at(distance, asked_.overlap));
    report(leaf, c, r, crease.x() > 0 ? Where::crease_x : Where::crease_y, on, normal, distance, is_least);
  }

  // If the body's normals at the edge hold -normal it is a contact; if nearly, and deep, a way out at least.
  void report(const Leaf& leaf, int c, int r, Where where, const Vec3& q, const Vec3& normal, double distance,
              bool is_least = true) const {
    if (distance < -asked_.overlap || !asked_.surface.placement().covers(q)) return;
    double leaning = 0;
    for (const Vec3& inward : edge_.inward) leaning = std::max(leaning, -normal.dot(inward));
    if (leaning > slack) return;
    if (edge_.radius == 0 && distance < 0 && !is_way_out(asked_.surface, q + distance * normal, distance))
      return;
    const Candidate met{q, normal, distance - edge_.radius,
                        feature_id(leaf.i + c, leaf.j + r, where, Part::edge, edge_.index, asked_.child)};
    if (is_least && leaning <= slack_at(distance, asked_.overlap)) {
      asked_.found.add(met);
    } else if (met.distance < 0) {
      asked_.found.add_spare(met);
    }
  }

  const Asked& asked_;
  const StraightEdge& edge_;
  Vec3 along_;
  Vec2 inverse_;  // of its parts; infinite where there is none
  double length2_;
  Rod rod_;
};

}  // namespace

void edge_pairs(const Asked& asked, const StraightEdge& edge) {
  EdgeSearch(asked, edge).run();
}

}  // namespace intaglio::contact
