// The rim of a cylinder against corners, creases and patches of the relief: arc by arc, so that only texels
// near an arc are asked.

#include "contact/cylinder_pairs.h"

#include <cmath>
#include <numbers>
#include <optional>

#include "contact/body_extent.h"
#include "contact/face_pairs.h"
#include "contact/leaf_walk.h"
#include "contact/pairs.h"
#include "core/portable_math.h"

namespace intaglio::contact {

namespace {

constexpr std::size_t arcs = 16;
constexpr double half_arc = std::numbers::pi / arcs;

class RimSearch {
 public:
  RimSearch(const Asked& asked, const Rim& rim)
      : asked_(asked), rim_(rim), circle_(rim.centre, rim.normal, rim.radius) {}

  void run() {
    const double cos_half = elementary::cos(half_arc), sagitta = rim_.radius * (1 - cos_half);
    std::array<std::optional<Rod>, arcs> rods;
    std::array<RimPoint, arcs> middles;
    Vec2 low = rim_.centre.head<2>(), high = low;
    for (std::size_t k = 0; k < arcs; ++k) {
      const double angle = 2 * half_arc * double(k);
      middles[k] = circle_.at(angle);
      const Vec3 a = circle_.at(angle - half_arc).point, b = circle_.at(angle + half_arc).point;
      const Rod rod(a, b, asked_.found.limit() + sagitta, asked_.overlap + sagitta);
      if (std::min(a.z(), b.z()) > rod.reach()) continue;
      rods[k] = rod;
      low = low.cwiseMin(rod.low());
      high = high.cwiseMax(rod.high());
    }
    const auto meets = [](const Piece& piece, const std::optional<Rod>& rod) {
      return rod && rod->may_meet(piece);
    };
    for_each_leaf(
        asked_.surface, low, high,
        [&](const Piece& piece) {
          return std::any_of(rods.begin(), rods.end(), [&](const auto& rod) { return meets(piece, rod); });
        },
        [&](int i, int j) {
          const Leaf leaf(asked_.surface, i, j);
          const Piece piece = piece_of_leaf(asked_.surface, i, j);
          for (std::size_t k = 0; k < arcs; ++k) {
            if (!meets(piece, rods[k])) continue;
            middle_angle_ = 2 * half_arc * double(k);
            middle_ = middles[k].out;
            cos_half_ = cos_half;
            search_leaf(*this, leaf, texels_up(leaf, *rods[k]));
          }
        });
  }

  // The rim's point nearest to a corner is in the corner's direction.
  void corner(const Leaf& leaf, int c, int r) const {
    const Vec3 q = leaf.texel(c, r), from = q - rim_.centre;
    const Vec3 across = from - from.dot(rim_.normal) * rim_.normal;
    if (across.squaredNorm() == 0) return;
    const RimPoint at = circle_.towards(across);
    if (!is_in_arc(at)) return;
    const Vec3 apart = at.point - q;
    const double d = apart.norm();
    if (d < 1e-9 || !(apart.z() > 0) ||
        !leaf.is_summit(c, r, -apart.x() / apart.z(), -apart.y() / apart.z(), 0, 0))
      return;
    report(leaf, c, r, Where::corner, q, apart / d, d, at);
  }

  void crease_x(const Leaf& leaf, int c, int r) const { crease(leaf, c, r, 1, 0); }
  void crease_y(const Leaf& leaf, int c, int r) const { crease(leaf, c, r, 0, 1); }

  void patch(const Leaf& leaf, int c, int r) const {
    const double z = leaf.at(c, r), a = leaf.at(c + 1, r) - z, b = leaf.at(c, r + 1) - z;
    const RimPatch search(circle_,
                          {leaf.texel(c, r), leaf.w, leaf.h, a, b, leaf.at(c + 1, r + 1) - z - a - b});
    const auto met = search.run(std::max(asked_.found.limit(), asked_.overlap), middle_, cos_half_);
    if (met && is_in_arc(met->at))
      report(leaf, c, r, Where::patch, met->on, met->normal, (met->at.point - met->on).dot(met->normal),
             met->at);
  }

 private:
  bool is_in_arc(const RimPoint& at) const { return at.out.dot(middle_) >= cos_half_ - 1e-9; }

  // From texel (c, r) to (c + x, r + y): stationary where what is between a point of the rim and the crease,
  // square to the crease, has no part along the rim.
  void crease(const Leaf& leaf, int c, int r, int x, int y) const {
    // Nowhere a ridge, it is met nowhere.
    const auto bend = [&](int end) {
      const int i = c + end * x, j = r + end * y;
      return 2 * leaf.at(i, j) - leaf.at(i - y, j - x) - leaf.at(i + y, j + x);
    };
    look_under(leaf, c, r, x);
    if (std::max(bend(0), bend(1)) <= 0) return;
    const Vec3 along(x * leaf.w, y * leaf.h, leaf.at(c + x, r + y) - leaf.at(c, r));
    const double length2 = along.squaredNorm();
    const auto across = [&](const Vec3& e) { return Vec3(e - e.dot(along) / length2 * along); };
    const Vec3 from = rim_.centre - leaf.texel(c, r), u = across(circle_.u), v = across(circle_.v);
    const CircleWave wave{from.dot(v), -from.dot(u), rim_.radius * circle_.u.dot(v),
                          0.5 * rim_.radius * (circle_.v.dot(v) - circle_.u.dot(u))};
    wave.for_each_zero(middle_angle_, half_arc,
                       [&](double angle) { meet_crease(leaf, c, r, x, along, circle_.at(angle)); });
  }

  // Where rim and crease cross in plan, a rim below shows an overlap (pairs.cpp).
  void look_under(const Leaf& leaf, int c, int r, int x) const {
    if (asked_.found.overlaps()) return;
    const int across = x == 1 ? 1 : 0, along = 1 - across;
    const Vec3 q = leaf.texel(c, r);
    const double size = along == 0 ? leaf.w : leaf.h, a = circle_.u[across], b = circle_.v[across],
                 amplitude = elementary::hypot(a, b), off = (q[across] - rim_.centre[across]) / rim_.radius;
    if (!(std::abs(off) < amplitude)) return;
    const double first = elementary::atan2(b, a), turn = elementary::acos(off / amplitude);
    for (const double angle : {first - turn, first + turn}) {
      const RimPoint at = circle_.at(angle);
      const double t = (at.point[along] - q[along]) / size;
      const double z = q.z() + t * (leaf.at(c + x, r + 1 - x) - q.z()), gap = at.point.z() - z;
      if (t < 0 || t > 1 || gap >= 0 || !is_in_arc(at)) continue;
      const Vec3 on = at.point - gap * Vec3::UnitZ();
      if (!asked_.surface.placement().covers(on)) continue;
      asked_.found.add_witness({on, Vec3::UnitZ(), gap,
                                feature_id(leaf.i + c, leaf.j + r, x == 1 ? Where::crease_x : Where::crease_y,
                                           Part::edge, rim_.index, asked_.child)});
    }
  }

  void meet_crease(const Leaf& leaf, int c, int r, int x, const Vec3& along, const RimPoint& at) const {
    const int y = 1 - x;
    const Vec3 q = leaf.texel(c, r);
    const Vec3 &p = at.point, upward = at.tangent.cross(along);
    const double t = (p - q).dot(along) / along.squaredNorm();
    if (t < 0 || t > 1 || !(std::abs(upward.z()) > 1e-6 * upward.norm())) return;
    const Vec3 normal = std::copysign(1 / upward.norm(), upward.z()) * upward, on = q + t * along;
    // The slopes of both patches at the crease, across it.
    const auto rise = [&](int side) {
      return (1 - t) * leaf.at(c + side * y, r + side * x) + t * leaf.at(c + x + side * y, r + y + side * x) -
             on.z();
    };
    const double size = x == 1 ? leaf.h : leaf.w;
    const double behind = -rise(-1) / size, ahead = rise(1) / size;
    const double slope = -(x == 1 ? normal.y() : normal.x()) / normal.z(), distance = (p - on).dot(normal);
    if (!(behind - ahead > flat_bend)) return;
    const double more = slope_slack(slack_at(distance, asked_.overlap), slope * slope);
    report(leaf, c, r, x == 1 ? Where::crease_x : Where::crease_y, on, normal, distance, at,
           slope <= behind + more && slope >= ahead - more);
  }

  // If the normals of the rim hold -normal it is a contact; else, where the rim is under the relief, a way
  // out at least.
  void report(const Leaf& leaf, int c, int r, Where where, const Vec3& q, const Vec3& normal, double distance,
              const RimPoint& at, bool is_least = true) const {
    if (distance < -asked_.overlap || !asked_.surface.placement().covers(q)) return;
    if (distance < 0 && !is_way_out(asked_.surface, at.point, distance)) return;
    const double leaning = std::max(normal.dot(rim_.normal), normal.dot(at.out));
    const Candidate met{q, normal, distance,
                        feature_id(leaf.i + c, leaf.j + r, where, Part::edge, rim_.index, asked_.child)};
    if (is_least && leaning <= slack_at(distance, asked_.overlap)) {
      asked_.found.add(met);
    } else if (distance < 0) {
      asked_.found.add_spare(met);
    }
  }

  const Asked& asked_;
  const Rim& rim_;
  Circle circle_;
  double middle_angle_ = 0, cos_half_ = 1;  // of the arc
  Vec3 middle_ = Vec3::Zero();
};

}  // namespace

void rim_pairs(const Asked& asked, const Rim& rim) {
  RimSearch(asked, rim).run();
}

// A cylinder: its axis as a rod with a radius, two flat ends, two rims.

void cylinder_pairs(const Asked& asked, const Cylinder& cylinder, const Frame& frame) {
  const Vec3 axis = frame.axes.col(1), reach = cylinder.half_height * axis;
  const double r = cylinder.radius;
  // Lowest points first: on a plane there are no others.
  feet::of(cylinder, frame, [&](const Foot& foot) {
    const Vec3 end = foot.index & 1 ? axis : Vec3(-axis);
    const Vec3 out = (foot.point - frame.origin - cylinder.half_height * end) / r;
    const std::array<Vec3, 2> around = {-end, -out};
    corner_pairs(asked, foot.point, around, 0, foot.index);
  });
  edge_pairs(asked, {frame.origin - reach, frame.origin + reach, {}, r, 2});
  for (const int end : {0, 1}) {
    const Vec3 normal = end == 0 ? Vec3(-axis) : axis, centre = frame.origin + cylinder.half_height * normal;
    // What a disc reaches in plan.
    const Vec2 aside(r * std::sqrt(std::max(0.0, 1 - axis.x() * axis.x())),
                     r * std::sqrt(std::max(0.0, 1 - axis.y() * axis.y())));
    rim_pairs(asked, {centre, normal, r, end});
    if (!(normal.z() < 0)) continue;
    const auto inside = [&](const Vec3& q, double distance, const auto&) {
      const Vec3 from = q - centre;
      const double beside = (from - from.dot(normal) * normal).norm() - r;
      return beside <= (distance < 0 ? 0.5 * distance : 0);
    };
    side_pairs(asked, {normal, normal.dot(centre), centre.head<2>() - aside, centre.head<2>() + aside, end},
               inside);
  }
}

}  // namespace intaglio::contact
