#include "contact/cylinder_pairs.h"

#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "contact/body_extent.h"
#include "contact/face_pairs.h"
#include "contact/leaf_walk.h"
#include "core/portable_math.h"

namespace intaglio::contact {

namespace {

// The rim of a cylinder: a circle where the side meets the end with that outer normal.
struct Rim {
  Vec3 centre, normal;
  double radius;
  int index;
};

// A rim against corners, creases and patches of the relief, in 16 arcs, to visit only texels near each arc.
constexpr std::size_t arcs = 16;
constexpr double half_arc = std::numbers::pi / arcs;

class RimSearch {
 public:
  RimSearch(const PairQuery& query, const Rim& rim)
      : query_(query),
        rim_(rim),
        circle_(rim.centre, rim.normal, rim.radius),
        cos_half_(elementary::cos(half_arc)) {}

  void run() {
    const double sagitta = rim_.radius * (1 - cos_half_);
    std::array<std::optional<EdgeBounds>, arcs> bounds;
    std::array<RimPoint, arcs> middles;
    Vec2 low = rim_.centre.head<2>(), high = low;
    for (std::size_t k = 0; k < arcs; ++k) {
      const double angle = 2 * half_arc * double(k);
      middles[k] = circle_.at(angle);
      const Vec3 a = circle_.at(angle - half_arc).point, b = circle_.at(angle + half_arc).point;
      const EdgeBounds own(a, b, query_.found.max_distance() + sagitta, query_.max_penetration + sagitta);
      if (std::min(a.z(), b.z()) > own.reach()) continue;
      bounds[k] = own;
      low = low.cwiseMin(own.low());
      high = high.cwiseMax(own.high());
    }
    const auto may_touch = [](const SlabPiece& piece, const std::optional<EdgeBounds>& own) {
      return own && own->may_contain_contact(piece);
    };
    for_each_leaf(
        query_.surface, low, high,
        [&](const SlabPiece& piece) {
          return std::any_of(bounds.begin(), bounds.end(),
                             [&](const auto& own) { return may_touch(piece, own); });
        },
        [&](int i, int j) {
          const Leaf leaf(query_.surface, i, j);
          const SlabPiece piece = slab_of_leaf(query_.surface, i, j);
          for (std::size_t k = 0; k < arcs; ++k) {
            if (!may_touch(piece, bounds[k])) continue;
            middle_angle_ = 2 * half_arc * double(k);
            middle_ = middles[k].out;
            visit_features(*this, leaf, mask_near(leaf, *bounds[k]));
          }
        });
  }

  // The rim's point nearest to a corner is in the corner's direction.
  void corner(const Leaf& leaf, int c, int r) const {
    const Vec3 q = leaf.texel(c, r), from = q - rim_.centre;
    const Vec3 across = from - from.dot(rim_.normal) * rim_.normal;
    if (across.squaredNorm() == 0) return;
    const RimPoint rim = circle_.towards(across);
    if (!is_in_arc(rim)) return;
    const Vec3 gap = rim.point - q;
    const double d = gap.norm();
    if (d < 1e-9 || !(gap.z() > 0) || !leaf.is_summit(c, r, -gap.x() / gap.z(), -gap.y() / gap.z(), 0, 0))
      return;
    add(leaf, c, r, ReliefFeature::corner, {q, gap / d, rim}, d);
  }

  // From texel (c, r) to (c + x, r + y).
  void crease(const Leaf& leaf, int c, int r, int x, int y) const {
    // Twice the height of the crease over its neighbours, at one of its ends.
    const auto bend = [&](int end) {
      const int i = c + end * x, j = r + end * y;
      return 2 * leaf.at(i, j) - leaf.at(i - y, j - x) - leaf.at(i + y, j + x);
    };
    look_under(leaf, c, r, x);
    // Not convex at either end: no contact.
    if (std::max(bend(0), bend(1)) <= 0) return;
    const Vec3 along(x * leaf.w, y * leaf.h, leaf.at(c + x, r + y) - leaf.at(c, r));
    TrigPolynomial::stationary_to_line(circle_, leaf.texel(c, r), along)
        .for_each_zero(middle_angle_, half_arc,
                       [&](double angle) { add_crease(leaf, c, r, x, along, circle_.at(angle)); });
  }

  void patch(const Leaf& leaf, int c, int r) const {
    const double z = leaf.at(c, r), a = leaf.at(c + 1, r) - z, b = leaf.at(c, r + 1) - z;
    const RimPatch search(circle_,
                          {leaf.texel(c, r), leaf.w, leaf.h, a, b, leaf.at(c + 1, r + 1) - z - a - b});
    const auto contact =
        search.find(std::max(query_.found.max_distance(), query_.max_penetration), middle_, cos_half_);
    if (contact && is_in_arc(contact->rim))
      add(leaf, c, r, ReliefFeature::patch, *contact,
          (contact->rim.point - contact->on).dot(contact->normal));
  }

 private:
  bool is_in_arc(const RimPoint& rim) const { return rim.out.dot(middle_) >= cos_half_ - 1e-9; }

  // Where rim and crease cross in plan.
  void look_under(const Leaf& leaf, int c, int r, int x) const {
    if (query_.found.overlaps()) return;
    const int across = x == 1 ? 1 : 0, along = 1 - across;
    const Vec3 q = leaf.texel(c, r);
    const double size = along == 0 ? leaf.w : leaf.h, a = circle_.u[across], b = circle_.v[across],
                 amplitude = elementary::hypot(a, b),
                 offset = (q[across] - rim_.centre[across]) / rim_.radius;
    if (!(std::abs(offset) < amplitude)) return;
    const double first = elementary::atan2(b, a), turn = elementary::acos(offset / amplitude);
    for (const double angle : {first - turn, first + turn}) {
      const RimPoint rim = circle_.at(angle);
      const double t = (rim.point[along] - q[along]) / size;
      const double z = q.z() + t * (leaf.at(c + x, r + 1 - x) - q.z());
      if (t < 0 || t > 1 || !is_in_arc(rim)) continue;
      add_crossing(query_, leaf, c, r, x, rim_.index, rim.point, z);
    }
  }

  void add_crease(const Leaf& leaf, int c, int r, int x, const Vec3& along, const RimPoint& rim) const {
    const int y = 1 - x;
    const Vec3 q = leaf.texel(c, r);
    const Vec3 &p = rim.point, upward = rim.tangent.cross(along);
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
    const double slack = slope_slack(normal_slack_at(distance, query_.max_penetration), slope * slope);
    add(leaf, c, r, x == 1 ? ReliefFeature::crease_x : ReliefFeature::crease_y, {on, normal, rim}, distance,
        slope <= behind + slack && slope >= ahead - slack);
  }

  void add(const Leaf& leaf, int c, int r, ReliefFeature feature, const RimPatch::Contact& contact,
           double distance, bool is_minimum = true) const {
    const Vec3& normal = contact.normal;
    const double lean = std::max(normal.dot(rim_.normal), normal.dot(contact.rim.out));
    add_edge_contact(query_, leaf, rim_.index,
                     {feature, c, r, contact.on, normal, contact.rim.point, distance, 0, lean, is_minimum});
  }

  const PairQuery& query_;
  const Rim& rim_;
  Circle circle_;
  double cos_half_;
  // The arc that is searched: angle and direction of its middle.
  double middle_angle_ = 0;
  Vec3 middle_ = Vec3::Zero();
};

}  // namespace

void cylinder_pairs(const PairQuery& query, const Cylinder& cylinder, const Frame& frame) {
  const Vec3 axis = frame.axes.col(1), half_length = cylinder.half_height * axis;
  const double r = cylinder.radius;
  // Lowest rim points first; on a flat patch they are the only contacts.
  internal::visit_support(cylinder, frame, [&](const SupportPoint& support) {
    const Vec3 end = support.index & 1 ? axis : Vec3(-axis);
    const Vec3 out = (support.point - frame.origin - cylinder.half_height * end) / r;
    const std::array<Vec3, 2> edges = {-end, -out};
    corner_pairs(query, support.point, edges, 0, support.index);
  });
  edge_pairs(query, {frame.origin - half_length, frame.origin + half_length, {}, r, 2});
  for (const int end : {0, 1}) {
    const Vec3 normal = end == 0 ? Vec3(-axis) : axis, centre = frame.origin + cylinder.half_height * normal;
    // Half extents of the disc in plan.
    const Vec2 half(r * std::sqrt(std::max(0.0, 1 - axis.x() * axis.x())),
                    r * std::sqrt(std::max(0.0, 1 - axis.y() * axis.y())));
    RimSearch(query, {centre, normal, r, end}).run();
    if (!(normal.z() < 0)) continue;
    const auto counts = [&](const Vec3& q, double distance, const auto&) {
      const Vec3 from = q - centre;
      const double beside = (from - from.dot(normal) * normal).norm() - r;
      return beside <= (distance < 0 ? 0.5 * distance : 0);
    };
    flat_face_pairs(
        query, {normal, normal.dot(centre), centre.head<2>() - half, centre.head<2>() + half, end}, counts);
  }
}

}  // namespace intaglio::contact
