// The rim of a cylinder against corners, creases and patches of the relief: arc by arc, so that each has one
// place at most where the distance is stationary, found by a change of sign.
#include <cmath>
#include <numbers>

#include "intaglio/contact/pairs.h"
#include "intaglio/contact/rod.h"
#include "intaglio/contact/slack.h"

namespace intaglio::contact {

namespace {

constexpr int arcs = 16;

// A root of a function that has opposite signs at both ends: regula falsi, Illinois.
template <class Function>
double root(double from, double to, double f_from, double f_to, const Function& function) {
  for (int round = 0; round < 60 && std::abs(to - from) > 1e-13; ++round) {
    const double at = to - f_to * (to - from) / (f_to - f_from), f = function(at);
    if (f == 0) return at;
    if ((f < 0) == (f_to < 0)) {
      f_from *= 0.5;
    } else {
      from = to;
      f_from = f_to;
    }
    const bool done = std::abs(at - to) < 1e-13;
    to = at;
    f_to = f;
    if (done) break;
  }
  return to;
}

class RimSearch {
 public:
  RimSearch(const Asked& asked, const Rim& rim) : asked_(asked), rim_(rim) {
    // Any two axes across; the same for the same attitude.
    const Vec3 other = std::abs(rim.normal.x()) < 0.7 ? Vec3::UnitX() : Vec3::UnitY();
    u_ = rim.normal.cross(other).normalized();
    v_ = rim.normal.cross(u_);
  }

  void run() {
    const double sagitta = rim_.radius * (1 - std::cos(std::numbers::pi / arcs));
    for (int k = 0; k < arcs; ++k) {
      from_ = place(2 * std::numbers::pi * k / arcs);
      to_ = place(2 * std::numbers::pi * (k + 1) / arcs);
      const Rod rod(from_.point, to_.point, asked_.found.limit() + sagitta, asked_.overlap + sagitta);
      if (std::min(from_.point.z(), to_.point.z()) > rod.reach()) continue;
      for_each_leaf(
          asked_.surface, rod.low(), rod.high(), [&](const Piece& piece) { return rod.may_meet(piece); },
          [&](int i, int j) {
            const Leaf leaf(asked_.surface, i, j);
            search_leaf(*this, leaf, texels_up(leaf, rod));
          });
    }
  }

  void corner(const Leaf& leaf, int c, int r) const {
    const Vec3 q = leaf.texel(c, r);
    Place at;
    if (!find([&](const Place& p) { return (p.point - q).dot(p.tangent); }, at)) return;
    const Vec3 apart = at.point - q;
    const double d = apart.norm();
    if (d < 1e-9 || !(apart.z() > 0) ||
        !leaf.is_summit(c, r, -apart.x() / apart.z(), -apart.y() / apart.z(), 0, 0))
      return;
    report(leaf, c, r, Where::corner, q, apart / d, d, at);
  }

  void crease_x(const Leaf& leaf, int c, int r) const { crease(leaf, c, r, 1, 0); }
  void crease_y(const Leaf& leaf, int c, int r) const { crease(leaf, c, r, 0, 1); }

  // The inside of a patch: the normal at the foot of a rim point is square to the rim there.
  void patch(const Leaf& leaf, int c, int r) const {
    const Vec3 q = leaf.texel(c, r);
    const double a = leaf.at(c + 1, r) - q.z(), b = leaf.at(c, r + 1) - q.z(),
                 twist = leaf.at(c + 1, r + 1) - q.z() - a - b;
    // Square to the rim the normal can only be where its part along the rim changes its sign.
    const auto range = [&](const Vec3& e) {
      const double x = e.x() / leaf.w, y = e.y() / leaf.h, g = e.z() - a * x - b * y;
      return std::pair(g + std::min(-twist * x, 0.0) + std::min(-twist * y, 0.0),
                       g + std::max(-twist * x, 0.0) + std::max(-twist * y, 0.0));
    };
    const auto start = range(from_.tangent), end = range(to_.tangent);
    if (std::min(start.first, end.first) > 0 || std::max(start.second, end.second) < 0) return;
    double s = 0.5, t = 0.5;
    Vec3 on, normal;
    const auto slope_along = [&](const Place& from) {
      const Vec3 p = from.point - q;
      for (int round = 0; round < 8; ++round) {  // Newton: the foot of p on the patch, however far it goes on
        const double z_s = a + t * twist, z_t = b + s * twist;
        const Vec3 d = Vec3(s * leaf.w, t * leaf.h, s * a + t * b + s * t * twist) - p;
        const double g_s = d.x() * leaf.w + d.z() * z_s, g_t = d.y() * leaf.h + d.z() * z_t;
        const double ss = leaf.w * leaf.w + z_s * z_s, tt = leaf.h * leaf.h + z_t * z_t,
                     st = z_s * z_t + d.z() * twist, det = ss * tt - st * st;
        if (!(std::abs(det) > 1e-9 * ss * tt)) break;
        const double step_s = -(tt * g_s - st * g_t) / det, step_t = -(ss * g_t - st * g_s) / det;
        s = std::clamp(s + step_s, -8.0, 9.0);
        t = std::clamp(t + step_t, -8.0, 9.0);
        if (std::abs(step_s) + std::abs(step_t) < 1e-12) break;
      }
      on = Vec3(s * leaf.w, t * leaf.h, s * a + t * b + s * t * twist);
      normal = Vec3(-(a + t * twist) / leaf.w, -(b + s * twist) / leaf.h, 1).normalized();
      return normal.dot(from.tangent);
    };
    Place at;
    if (!find(slope_along, at)) return;
    slope_along(at);
    if (s < 0 || s > 1 || t < 0 || t > 1) return;
    report(leaf, c, r, Where::patch, q + on, normal, (at.point - q - on).dot(normal), at);
  }

 private:
  struct Place {
    double angle;
    Vec3 point, out, tangent;
  };
  Place place(double angle) const {
    const double c = std::cos(angle), s = std::sin(angle);
    const Vec3 out = c * u_ + s * v_;
    return {angle, rim_.centre + rim_.radius * out, out, c * v_ - s * u_};
  }

  // Whether f changes its sign along the arc, and where.
  template <class Function>
  bool find(const Function& f, Place& at) const {
    const double f_from = f(from_), f_to = f(to_);
    if ((f_from < 0) == (f_to < 0)) return false;
    at = place(root(from_.angle, to_.angle, f_from, f_to, [&](double angle) { return f(place(angle)); }));
    return true;
  }

  // From texel (c, r) to (c + x, r + y): stationary where the circle's tangent has no part along what is
  // between them, square to the crease.
  void crease(const Leaf& leaf, int c, int r, int x, int y) const {
    const Vec3 q = leaf.texel(c, r), along(x * leaf.w, y * leaf.h, leaf.at(c + x, r + y) - q.z());
    const double length2 = along.squaredNorm();
    // Nowhere a ridge, it is met nowhere.
    const auto bend = [&](int end) {
      const int i = c + end * x, j = r + end * y;
      return 2 * leaf.at(i, j) - leaf.at(i - y, j - x) - leaf.at(i + y, j + x);
    };
    if (std::max(bend(0), bend(1)) <= 0) return;
    const auto beside = [&](const Place& p) {
      const Vec3& e = p.tangent;
      return (p.point - q).dot(e - e.dot(along) / length2 * along);
    };
    Place at;
    if (!find(beside, at)) return;
    const Vec3 &p = at.point, upward = at.tangent.cross(along);
    const double t = (p - q).dot(along) / length2;
    if (t < 0 || t > 1 || !(std::abs(upward.z()) > 1e-6 * upward.norm())) return;
    const Vec3 normal = std::copysign(1 / upward.norm(), upward.z()) * upward, on = q + t * along;
    // The slopes of both patches at the crease, across it.
    const auto rise = [&](int side) {
      return (1 - t) * leaf.at(c + side * y, r + side * x) + t * leaf.at(c + x + side * y, r + y + side * x) -
             on.z();
    };
    const double across = x == 1 ? leaf.h : leaf.w;
    const double behind = -rise(-1) / across, ahead = rise(1) / across;
    const double slope = -(x == 1 ? normal.y() : normal.x()) / normal.z(), distance = (p - on).dot(normal),
                 more = slope_slack(slack_at(distance, asked_.overlap), slope * slope);
    if (!(behind - ahead > flat_bend) || slope > behind + more || slope < ahead - more) return;
    report(leaf, c, r, x == 1 ? Where::crease_x : Where::crease_y, on, normal, distance, at);
  }

  // Whether the normals of the rim hold -normal; then it is a contact.
  void report(const Leaf& leaf, int c, int r, Where where, const Vec3& q, const Vec3& normal, double distance,
              const Place& at) const {
    const double most = slack_at(distance, asked_.overlap);
    if (distance < -asked_.overlap || normal.dot(rim_.normal) > most || normal.dot(at.out) > most ||
        !asked_.surface.placement().covers(q))
      return;
    asked_.found.add({q, normal, distance,
                      feature_id(leaf.i + c, leaf.j + r, where, Part::edge, rim_.index, asked_.child)});
  }

  const Asked& asked_;
  const Rim& rim_;
  Vec3 u_, v_;
  Place from_, to_;  // of the arc
};

}  // namespace

void rim_pairs(const Asked& asked, const Rim& rim) {
  RimSearch(asked, rim).run();
}

}  // namespace intaglio::contact
