// Bounds on distance and direction for four blocks of relief at once, relative to the query point.
//
// Metres; the query point is the origin. A block lies in a box, and between two tilted planes (a slab). Lanes
// are the blocks; answers are masks, bit k for block k. T is float near the query point, double where float
// could not resolve the blocks. Every bound is widened by `rounding_slack` times the size of its terms, which
// exceeds the rounding error, so that pruning is conservative. Internal to surface/; pure, no allocation.
#pragma once

#include <limits>

#include "intaglio/vec.h"

namespace intaglio::surface {

template <class T>
using Four = Eigen::Array<T, 4, 1>;

template <class T>
inline constexpr T rounding_slack = 16 * std::numeric_limits<T>::epsilon();

// Bit k: a[k] < b[k].
template <class T>
unsigned less(const Four<T>& a, const Four<T>& b) {
  return unsigned(a[0] < b[0]) | unsigned(a[1] < b[1]) << 1 | unsigned(a[2] < b[2]) << 2 |
         unsigned(a[3] < b[3]) << 3;
}

template <class T>
struct Boxes {
  Four<T> x0, x1, y0, y1, z0, z1;  // x and y may be infinite

  Four<T> min_distance2() const {
    const Four<T> x = x0.max(-x1).max(T(0)), y = y0.max(-y1).max(T(0)), z = z0.max(-z1).max(T(0));
    return (1 - rounding_slack<T>)*(x * x + y * y + z * z);
  }
};

template <class T>
struct Slabs {
  Four<T> x, y, z;           // middle
  Four<T> slope_x, slope_y;  // of the plane
  Four<T> half_thickness;    // along z
  T w, h;                    // sides in plan

  // Half the height of the box around the slab.
  Four<T> half_height() const {
    return half_thickness + (T(0.5) * w) * slope_x.abs() + (T(0.5) * h) * slope_y.abs();
  }
  Boxes<T> boxes() const {
    const Four<T> thick = half_height();
    return {x - T(0.5) * w, x + T(0.5) * w, y - T(0.5) * h, y + T(0.5) * h, z - thick, z + thick};
  }
  // A lower bound on the squared distance.
  //
  // First for the plane z(u, v) = z + sx u + sy v over the rectangle |u| <= w/2, |v| <= h/2 about (x, y). Let
  // F be half the squared distance. In the middle its gradient is (x + z sx, y + z sy) = `grad`, and its
  // Hessian is
  //   [[1 + sx^2, sx sy], [sx sy, 1 + sy^2]] = [[a_xx, a_xy], [a_xy, a_yy]],
  //   determinant a_xx a_yy - a_xy^2 = 1 + sx^2 + sy^2 = a_xx + a_yy - 1.
  // A Newton step along x, clamped to the rectangle, and then the minimum along y for that x, clamped, lead
  // to `step`, which mostly is the nearest point. F is convex, hence above its tangent there: with the
  // gradient `grad_at` at the step,
  //   2 F(u, v) >= 2 F(step) + 2 grad_at . ((u, v) - step)
  //             >= 2 F(step) - (w |grad_at_x| + 2 grad_at_x step_x) - (h |grad_at_y| + 2 grad_at_y step_y).
  // At the exact minimum both brackets vanish, and the bound is the distance itself. Then the slab: its
  // relief is within half_thickness of the plane along z, and so is its distance. `size` bounds the terms of
  // the sum.
  Four<T> min_distance2() const {
    const T half_w = T(0.5) * w, half_h = T(0.5) * h;
    const Four<T> a_xx = slope_x.square() + T(1), a_xy = slope_x * slope_y, a_yy = slope_y.square() + T(1);
    const Four<T> grad_x = x + z * slope_x, grad_y = y + z * slope_y;
    const Four<T> step_x = ((a_xy * grad_y - a_yy * grad_x) / (a_xx + a_yy - T(1))).max(-half_w).min(half_w);
    const Four<T> step_y = (-(grad_y + a_xy * step_x) / a_yy).max(-half_h).min(half_h);
    const Four<T> grad_at_x = grad_x + a_xx * step_x + a_xy * step_y,
                  grad_at_y = grad_y + a_xy * step_x + a_yy * step_y;
    const Four<T> at_step =
        (x + step_x).square() + (y + step_y).square() + (z + slope_x * step_x + slope_y * step_y).square();
    const Four<T> deficit_x = w * grad_at_x.abs() + T(2) * grad_at_x * step_x,
                  deficit_y = h * grad_at_y.abs() + T(2) * grad_at_y * step_y;
    const Four<T> size = at_step + w * (x.abs() + (z * slope_x).abs() + a_xx * half_w + a_xy.abs() * half_h) +
                         h * (y.abs() + (z * slope_y).abs() + a_xy.abs() * half_w + a_yy * half_h);
    const Four<T> plane2 = at_step - deficit_x - deficit_y - rounding_slack<T> * size;
    return (plane2.max(T(0)).sqrt() - half_thickness).max(T(0)).square();
  }
  // Mask of the blocks in which the distance is strictly monotonic along an axis, so that there is no
  // interior minimum. Neighbouring cells are included, at most a quarter of the side on each side, so that
  // minima on the border are covered. There and in the block, slopes differ from the plane's by `spread` at
  // most.
  //
  // For x: d/dx of half the squared distance is x' + z' z_x, with x' within 0.75 w of x, z' within `rise` of
  // z, z_x within spread_x of slope_x. So it differs from x + z slope_x by at most
  //   0.75 w + |z| spread_x + rise (|slope_x| + spread_x),
  // and its sign is fixed where |x + z slope_x| exceeds that. `rise`: in the block the slab allows
  // half_thickness + 0.5 w |slope_x|, and the outer quarter 0.25 w (|slope_x| + spread_x) more; likewise in
  // y.
  unsigned monotonic(const Four<T>& spread_x, const Four<T>& spread_y) const {
    const Four<T> rise = half_thickness + w * (T(0.75) * slope_x.abs() + T(0.25) * spread_x) +
                         h * (T(0.75) * slope_y.abs() + T(0.25) * spread_y);
    const auto is_monotonic = [&](const Four<T>& at, T size, const Four<T>& slope, const Four<T>& spread) {
      const Four<T> tilt = z * slope;
      return less<T>(T(0.75) * size + z.abs() * spread + rise * (slope.abs() + spread) +
                         rounding_slack<T> * (at.abs() + tilt.abs()),
                     (at + tilt).abs());
    };
    return is_monotonic(x, w, slope_x, spread_x) | is_monotonic(y, h, slope_y, spread_y);
  }
};

// Four boxes clipped to a sphere around the query point, for tests of the rest against a cone.
template <class T>
class ClippedBoxes {
 public:
  ClippedBoxes(const Boxes<T>& boxes, T reach) {
    const Four<T> z = boxes.z0.max(-boxes.z1).max(T(0));
    const Four<T> radius2 = reach * reach - z * z;
    const Four<T> radius = radius2.max(T(0)).sqrt();
    x0_ = boxes.x0.max(-radius);
    x1_ = boxes.x1.min(radius);
    y0_ = boxes.y0.max(-radius);
    y1_ = boxes.y1.min(radius);
    z0_ = boxes.z0.max(-reach);
    z1_ = boxes.z1.min(reach);
    reach_ = reach;
    max_distance_ =
        (x0_.square().max(x1_.square()) + y0_.square().max(y1_.square()) + z0_.square().max(z1_.square()))
            .sqrt()
            .min(reach);
    empty_ = less<T>(radius2, Four<T>::Zero()) | less<T>(x1_, x0_) | less<T>(y1_, y0_);
  }

  // Bit k: every point of box k within reach lies inside the cone, or there is none. A point p does where
  // axis . p > cosine |p|; the left side is bounded from below, |p| by the farthest corner.
  unsigned boxes_in_cone(const Vec3& axis, double cosine) const {
    const T x = T(axis.x()), y = T(axis.y()), z = T(axis.z());
    const Four<T> least = min_product(x, x0_, x1_) + min_product(y, y0_, y1_) + min_product(z, z0_, z1_);
    return empty_ | less<T>(T(cosine) * max_distance_ + rounding_slack<T> * reach_, least);
  }
  // The same for the slabs in the boxes: z is replaced by the plane's height, which is linear in x and y.
  unsigned planes_in_cone(const Slabs<T>& p, const Vec3& axis, double cosine) const {
    const T x = T(axis.x()), y = T(axis.y()), z = T(axis.z());
    const Four<T> slope_term_x = p.x * p.slope_x, slope_term_y = p.y * p.slope_y;
    const Four<T> least = z * (p.z - slope_term_x - slope_term_y) - std::abs(z) * p.half_thickness +
                          min_product(x + z * p.slope_x, x0_, x1_) + min_product(y + z * p.slope_y, y0_, y1_);
    const Four<T> size = reach_ * (T(1) + p.slope_x.abs() + p.slope_y.abs()) + p.z.abs() +
                         slope_term_x.abs() + slope_term_y.abs();
    return empty_ | less<T>(T(cosine) * max_distance_ + rounding_slack<T> * size, least);
  }

 private:
  template <class K>
  static Four<T> min_product(const K& k, const Four<T>& low, const Four<T>& high) {
    return (k * low).min(k * high);
  }

  Four<T> x0_, x1_, y0_, y1_, z0_, z1_, max_distance_;
  T reach_;
  unsigned empty_;
};

}  // namespace intaglio::surface
