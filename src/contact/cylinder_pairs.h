// A cylinder against the relief: its axis as an edge with a radius, two flat ends, two rims. Internal to
// contact/.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "contact/pairs.h"
#include "core/portable_math.h"
#include "intaglio/vec.h"

namespace intaglio::contact {

void cylinder_pairs(const PairQuery& query, const Cylinder& cylinder, const Frame& frame);

// The parts of a rim's search that know nothing of the relief but one line or one patch.

struct RimPoint {
  Vec3 point, out, tangent;  // out and tangent are unit
};

// The rim of a disc with that unit normal: point(x) = centre + radius (cos x u + sin x v).
struct Circle {
  Vec3 centre, normal, u, v;
  double radius;

  Circle(const Vec3& middle, const Vec3& axis, double r) : centre(middle), normal(axis), radius(r) {
    // Arbitrary but deterministic axes in the plane.
    const Vec3 other = std::abs(axis.x()) < 0.7 ? Vec3::UnitX() : Vec3::UnitY();
    u = axis.cross(other).normalized();
    v = axis.cross(u);
  }
  RimPoint at(double angle) const {
    const auto [sine, cosine] = elementary::sin_cos(angle);
    return towards(cosine * u + sine * v);
  }
  // In a direction perpendicular to the normal.
  RimPoint towards(const Vec3& across) const {
    const Vec3 out = across.normalized();
    return {centre + radius * out, out, normal.cross(out)};
  }
};

// f(x) = a cos x + b sin x + c cos 2x + d sin 2x: zero where a circle's distance to a straight line is
// stationary (`stationary_to_line`).
//
// Zeros are isolated by bounds of the first two derivatives: |f'| <= A1 + 2 A2 and |f''| <= A1 + 4 A2 with
// A1 = |(a, b)|, A2 = |(c, d)|. In an interval of half width `half` around x there is none if
// |f(x)| > max|f'| half; there is at most one if |f'(x)| > max|f''| half, since f is monotone then; else the
// interval is halved. So no zero is lost, even when two are close. Up to four in a whole turn.
struct TrigPolynomial {
  double a, b, c, d;

  // The distance from a rim to the line through q along `crease`, as a function of the angle, is stationary
  // where the rim's tangent p' is perpendicular to the shortest connection. With the projection across the
  // line, P y = y - (y . crease) crease / |crease|^2, and f = centre - q, that is
  //   P (p - q) . p' = (P f + R cos x P u + R sin x P v) . (-sin x u + cos x v) R = 0.
  // By cos^2 - sin^2 = cos 2x, 2 sin cos = sin 2x and u . P v = v . P u, divided by R:
  //   f . P v cos x - f . P u sin x + R u . P v cos 2x + R/2 (v . P v - u . P u) sin 2x = 0.
  static TrigPolynomial stationary_to_line(const Circle& circle, const Vec3& q, const Vec3& crease) {
    const double length2 = crease.squaredNorm();
    const auto across = [&](const Vec3& e) { return Vec3(e - e.dot(crease) / length2 * crease); };
    const Vec3 from = circle.centre - q, u = across(circle.u), v = across(circle.v);
    return {from.dot(v), -from.dot(u), circle.radius * circle.u.dot(v),
            0.5 * circle.radius * (circle.v.dot(v) - circle.u.dot(u))};
  }

  // Value and slope at an angle.
  struct At {
    double value, slope;
  };
  At at(double angle) const {
    const auto [sine, cosine] = elementary::sin_cos(angle);
    const double cosine2 = cosine * cosine - sine * sine, sine2 = 2 * sine * cosine;
    return {a * cosine + b * sine + c * cosine2 + d * sine2,
            b * cosine - a * sine + 2 * (d * cosine2 - c * sine2)};
  }

  // Calls visit(angle) for the zeros in middle - half..middle + half; two that are within 1e-7 of each other
  // may be one.
  template <class Visit>
  void for_each_zero(double middle, double half, const Visit& visit) const {
    const At here = at(middle);
    const double amplitude1 = elementary::hypot(a, b), amplitude2 = elementary::hypot(c, d);
    if (std::abs(here.value) > (amplitude1 + 2 * amplitude2) * half) return;
    if (std::abs(here.slope) > (amplitude1 + 4 * amplitude2) * half) {
      const double from = middle - half, to = middle + half, f_from = at(from).value, f_to = at(to).value;
      if ((f_from < 0) == (f_to < 0)) return;
      visit(find_root([this](double angle) { return at(angle).value; }, from, to, f_from, f_to, 1e-13));
    } else if (half < 1e-7) {
      visit(middle);
    } else {
      for_each_zero(middle - 0.5 * half, 0.5 * half, visit);
      for_each_zero(middle + 0.5 * half, 0.5 * half, visit);
    }
  }
};

// Point at (s, t): first + (s w, t h, s a + t b + s t twist).
struct Patch {
  Vec3 first;
  double w, h, a, b, twist;

  Vec3 at(double s, double t) const { return first + Vec3(s * w, t * h, s * a + t * b + s * t * twist); }
  Vec3 along_s(double t) const { return {w, 0, a + t * twist}; }
  Vec3 along_t(double s) const { return {0, h, b + s * twist}; }
  Vec3 upward(double s, double t) const { return {-(a + t * twist) / w, -(b + s * twist) / h, 1}; }
};

// The local minimum of the gap between a circle and the inside of one bilinear patch.
//
// Let n(s, t) be the patch's upward normal and w = n - (n . v) v its part in the circle's plane, v the
// circle's normal. The point of the rim that can meet the patch there is the lowest along n,
//   p = centre - R w / |w|.
// Two equations are left: p is over q(s, t) along n, that is, p - q is perpendicular to the patch,
//   F = ((p - q) . q_s, (p - q) . q_t) = 0,
// solved by Newton's method from a few places. For its Jacobian: n_s = (0, -k/h, 0), n_t = (-k/w, 0, 0) with
// the twist k; p moves along the rim's tangent T only, p_s = -(R/|w|) (T . n_s) T and likewise p_t; and of
// the second derivatives of q only q_st = (0, 0, k) is not zero.
//
// A zero of F is a minimum along T only if the rim rises over the tangent plane at least as fast as the
// patch: along n, for a step along T, the second derivative of the rim is -(out . n) / R and that of the
// patch 2 k T_x T_y / (w h).
class RimPatch {
 public:
  struct Contact {
    Vec3 on, normal;  // of the patch; normal is unit
    RimPoint rim;
  };

  RimPatch(const Circle& circle, const Patch& patch) : circle_(circle), patch_(patch) {}

  // Finds a pair at most `reach` apart, at a point of the rim whose direction from the centre is within an
  // angle of `middle` whose cosine is `cos_half`. A patch that certainly has none is skipped early.
  std::optional<Contact> find(double reach, const Vec3& middle, double cos_half) const {
    if (patch_.twist == 0 || is_out_of_reach(reach, middle, cos_half)) return std::nullopt;
    for (const Vec2& start :
         {Vec2(0.5, 0.5), Vec2(0.1, 0.1), Vec2(0.9, 0.1), Vec2(0.1, 0.9), Vec2(0.9, 0.9)}) {
      const auto end = newton_from(start.x(), start.y());
      if (!end) continue;
      if (const auto contact = contact_at(end->x(), end->y())) return contact;
      // The patch is nearly planar, so a solution this far outside is the only one; stop.
      if (start.x() == 0.5 && (*end - start).cwiseAbs().maxCoeff() > 0.75) break;
    }
    return std::nullopt;
  }

 private:
  Vec3 across(const Vec3& n) const { return n - n.dot(circle_.normal) * circle_.normal; }

  // Over the patch n differs from that of its middle by at most turn = |k|/2 |(1/w, 1/h)|. If |w| > 2 turn,
  // the direction of w differs by at most 2 turn / |w|, and the rim's point by R times that.
  bool is_out_of_reach(double reach, const Vec3& arc, double cos_half) const {
    const Vec3 middle = patch_.upward(0.5, 0.5), w = across(middle);
    const double turn = 0.5 * std::abs(patch_.twist) * elementary::hypot(1 / patch_.w, 1 / patch_.h);
    const double length = w.norm();
    if (length <= 2 * turn) return false;
    if (-w.dot(arc) < (cos_half - 2 * turn / length) * length) return true;
    const Vec3 on = patch_.at(0.5, 0.5);
    const double half = 0.5 * std::sqrt(patch_.w * patch_.w + patch_.h * patch_.h) +
                        0.5 * (std::abs(patch_.a) + std::abs(patch_.b)) + std::abs(patch_.twist);
    return (circle_.towards(-w).point - on).norm() > reach + half + 2 * turn / length * circle_.radius;
  }

  std::optional<Vec2> newton_from(double s, double t) const {
    for (int iteration = 0; iteration < 16; ++iteration) {
      const Vec3 n = patch_.upward(s, t), w = across(n);
      const double length = w.norm();
      if (length < 1e-9) return std::nullopt;
      const RimPoint rim = circle_.towards(-w);
      const Vec3 gap = rim.point - patch_.at(s, t), q_s = patch_.along_s(t), q_t = patch_.along_t(s);
      const double f_s = gap.dot(q_s), f_t = gap.dot(q_t);
      const double per = -circle_.radius / length;
      const Vec3 p_s = per * rim.tangent * (rim.tangent.y() * -patch_.twist / patch_.h),
                 p_t = per * rim.tangent * (rim.tangent.x() * -patch_.twist / patch_.w);
      const double ss = (p_s - q_s).dot(q_s), st = (p_t - q_t).dot(q_s) + gap.z() * patch_.twist,
                   ts = (p_s - q_s).dot(q_t) + gap.z() * patch_.twist, tt = (p_t - q_t).dot(q_t);
      const double det = ss * tt - st * ts;
      if (!(std::abs(det) > 1e-12 * (std::abs(ss * tt) + std::abs(st * ts)))) return std::nullopt;
      const double step_s = -(tt * f_s - st * f_t) / det, step_t = -(ss * f_t - ts * f_s) / det;
      s += std::clamp(step_s, -0.5, 0.5);
      t += std::clamp(step_t, -0.5, 0.5);
      if (s < -1 || s > 2 || t < -1 || t > 2) return std::nullopt;
      if (std::abs(step_s) + std::abs(step_t) < 1e-11) return Vec2(s, t);
    }
    return std::nullopt;
  }

  std::optional<Contact> contact_at(double s, double t) const {
    if (s < 0 || s > 1 || t < 0 || t > 1) return std::nullopt;
    const Vec3 upward = patch_.upward(s, t);
    const RimPoint rim = circle_.towards(-across(upward));
    const Vec3& e = rim.tangent;
    if (-rim.out.dot(upward) / circle_.radius < 2 * patch_.twist * e.x() * e.y() / (patch_.w * patch_.h))
      return std::nullopt;
    return Contact{patch_.at(s, t), upward.normalized(), rim};
  }

  const Circle& circle_;
  Patch patch_;
};

}  // namespace intaglio::contact
