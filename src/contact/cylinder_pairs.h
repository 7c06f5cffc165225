// The zeros of a cos t + b sin t + c cos 2t + d sin 2t in an arc: where a circle's distance to a straight
// line is stationary. Internal to contact/.
//
// Isolated by bounds of the first and the second derivative, so that none is lost, also when two are close
// together. Up to four in a whole turn. Bounded work, no allocation.
#pragma once

#include <cmath>
#include <optional>

#include "core/portable_math.h"
#include "intaglio/vec.h"

namespace intaglio::contact {

struct CircleWave {
  double a, b, c, d;

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
    const double one = elementary::hypot(a, b), two = elementary::hypot(c, d);
    if (std::abs(here.value) > (one + 2 * two) * half) return;
    if (std::abs(here.slope) > (one + 4 * two) * half) {
      const double from = middle - half, to = middle + half, f_from = at(from).value, f_to = at(to).value;
      if ((f_from < 0) != (f_to < 0)) visit(bracketed(from, to, f_from, f_to));
    } else if (half < 1e-7) {
      visit(middle);
    } else {
      for_each_zero(middle - 0.5 * half, 0.5 * half, visit);
      for_each_zero(middle + 0.5 * half, 0.5 * half, visit);
    }
  }

 private:
  // Regula falsi, Illinois, between ends of opposite signs.
  double bracketed(double from, double to, double f_from, double f_to) const {
    for (int round = 0; round < 60 && std::abs(to - from) > 1e-13; ++round) {
      const double next = to - f_to * (to - from) / (f_to - f_from), f = at(next).value;
      if (f == 0) return next;
      if ((f < 0) == (f_to < 0)) {
        f_from *= 0.5;
      } else {
        from = to;
        f_from = f_to;
      }
      const bool done = std::abs(next - to) < 1e-13;
      to = next;
      f_to = f;
      if (done) break;
    }
    return to;
  }
};

// Where a circle is stationary over the inside of one bilinear patch. Local frame, metres. Internal to
// contact/.

struct RimPoint {
  Vec3 point, out, tangent;  // out and tangent are unit
};

// The rim of a disc with that unit normal.
struct Circle {
  Vec3 centre, normal, u, v;
  double radius;

  Circle(const Vec3& middle, const Vec3& axis, double r) : centre(middle), normal(axis), radius(r) {
    // Any two axes across; the same for the same attitude.
    const Vec3 other = std::abs(axis.x()) < 0.7 ? Vec3::UnitX() : Vec3::UnitY();
    u = axis.cross(other).normalized();
    v = axis.cross(u);
  }
  RimPoint at(double angle) const {
    const auto [sine, cosine] = elementary::sin_cos(angle);
    return towards(cosine * u + sine * v);
  }
  // In a direction across the normal.
  RimPoint towards(const Vec3& across) const {
    const Vec3 out = across.normalized();
    return {centre + radius * out, out, normal.cross(out)};
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

// The patch's normal n at (s, t) says which point of the rim could meet it there: the lowest along n. What
// is left are two equations for s and t, that this point be over (s, t) along n: Newton, from a few places.
class RimPatch {
 public:
  struct Met {
    Vec3 on, normal;  // normal is unit
    RimPoint at;
  };

  RimPatch(const Circle& circle, const Patch& patch) : circle_(circle), patch_(patch) {}

  // A place where the gap is least along the rim; pairs farther apart than `reach` are not wanted, nor points
  // of the rim that are certainly not within half an arc's angle, of that cosine, of `middle`.
  std::optional<Met> run(double reach, const Vec3& middle, double cos_half) const {
    if (patch_.twist == 0 || is_beyond(reach, middle, cos_half)) return std::nullopt;
    for (const Vec2& start :
         {Vec2(0.5, 0.5), Vec2(0.1, 0.1), Vec2(0.9, 0.1), Vec2(0.1, 0.9), Vec2(0.9, 0.9)}) {
      const auto end = from(start.x(), start.y());
      if (!end) continue;
      if (const auto met = met_at(end->x(), end->y())) return met;
      // A patch is nearly a plane: what is that far out is the only place.
      if (start.x() == 0.5 && (*end - start).cwiseAbs().maxCoeff() > 0.75) break;
    }
    return std::nullopt;
  }

 private:
  Vec3 across(const Vec3& n) const { return n - n.dot(circle_.normal) * circle_.normal; }

  // How far the rim's point goes while (s, t) goes over the patch, and so how far off it is at least.
  bool is_beyond(double reach, const Vec3& arc, double cos_half) const {
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

  std::optional<Vec2> from(double s, double t) const {
    for (int round = 0; round < 16; ++round) {
      const Vec3 n = patch_.upward(s, t), w = across(n);
      const double length = w.norm();
      if (length < 1e-9) return std::nullopt;
      const RimPoint at = circle_.towards(-w);
      const Vec3 apart = at.point - patch_.at(s, t), q_s = patch_.along_s(t), q_t = patch_.along_t(s);
      const double f_s = apart.dot(q_s), f_t = apart.dot(q_t);
      // The rim's point moves along its tangent, as far as the normal turns that way.
      const double per = -circle_.radius / length;
      const Vec3 p_s = per * at.tangent * (at.tangent.y() * -patch_.twist / patch_.h),
                 p_t = per * at.tangent * (at.tangent.x() * -patch_.twist / patch_.w);
      const double ss = (p_s - q_s).dot(q_s), st = (p_t - q_t).dot(q_s) + apart.z() * patch_.twist,
                   ts = (p_s - q_s).dot(q_t) + apart.z() * patch_.twist, tt = (p_t - q_t).dot(q_t);
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

  std::optional<Met> met_at(double s, double t) const {
    if (s < 0 || s > 1 || t < 0 || t > 1) return std::nullopt;
    const Vec3 upward = patch_.upward(s, t);
    const RimPoint at = circle_.towards(-across(upward));
    // Along the rim it bends away faster than the patch follows.
    const Vec3& e = at.tangent;
    if (-at.out.dot(upward) / circle_.radius < 2 * patch_.twist * e.x() * e.y() / (patch_.w * patch_.h))
      return std::nullopt;
    return Met{patch_.at(s, t), upward.normalized(), at};
  }

  const Circle& circle_;
  Patch patch_;
};

}  // namespace intaglio::contact
