// Four pieces of the relief at once, as the asking point sees them: bounds on how far they are and on the
// directions that they fill.
//
// Metres; the asking point is the origin. A piece lies in a box, and within `play` along z of a tilted plane.
// Lanes are the pieces; answers are bits, bit k of piece k. T is float where the point is near, double where
// it is so far away that floats could not tell one block from another: every bound is loosened by `loss`,
// more than the arithmetic can be wrong by, so what is ruled out is ruled out for certain.
// Internal to surface/; pure, no allocation.
#pragma once

#include <limits>

#include "intaglio/vec.h"

namespace intaglio::surface {

template <class T>
using Four = Eigen::Array<T, 4, 1>;

template <class T>
inline constexpr T loss = 16 * std::numeric_limits<T>::epsilon();

// Bit k: a[k] < b[k].
template <class T>
unsigned less(const Four<T>& a, const Four<T>& b) {
  return unsigned(a[0] < b[0]) | unsigned(a[1] < b[1]) << 1 | unsigned(a[2] < b[2]) << 2 |
         unsigned(a[3] < b[3]) << 3;
}

template <class T>
struct Boxes {
  Four<T> x0, x1, y0, y1, z0, z1;  // x and y may be infinite

  Four<T> least_distance2() const {
    const Four<T> x = x0.max(-x1).max(T(0)), y = y0.max(-y1).max(T(0)), z = z0.max(-z1).max(T(0));
    return (1 - loss<T>)*(x * x + y * y + z * z);
  }
};

template <class T>
struct TiltedPieces {
  Four<T> x, y, z;           // middle
  Four<T> slope_x, slope_y;  // of the plane
  Four<T> play;
  T w, h;  // sides in plan

  // How far the plane is from its middle along z, play included.
  Four<T> thickness() const { return play + (T(0.5) * w) * slope_x.abs() + (T(0.5) * h) * slope_y.abs(); }
  Boxes<T> boxes() const {
    const Four<T> thick = thickness();
    return {x - T(0.5) * w, x + T(0.5) * w, y - T(0.5) * h, y + T(0.5) * h, z - thick, z + thick};
  }
  // The squared distance to the plane's piece is convex, hence above its tangent wherever that is taken: here
  // where a clamped Newton step ends, which mostly is the nearest point, and then the bound is exact.
  Four<T> least_distance2() const {
    const T half_w = T(0.5) * w, half_h = T(0.5) * h;
    const Four<T> e = slope_x.square() + T(1), f = slope_x * slope_y, g = slope_y.square() + T(1);
    const Four<T> g_x = x + z * slope_x, g_y = y + z * slope_y;
    const Four<T> at_x = ((f * g_y - g * g_x) / (e + g - T(1))).max(-half_w).min(half_w);
    const Four<T> at_y = (-(g_y + f * at_x) / g).max(-half_h).min(half_h);
    const Four<T> h_x = g_x + e * at_x + f * at_y, h_y = g_y + f * at_x + g * at_y;
    const Four<T> there =
        (x + at_x).square() + (y + at_y).square() + (z + slope_x * at_x + slope_y * at_y).square();
    const Four<T> less_x = w * h_x.abs() + T(2) * h_x * at_x, less_y = h * h_y.abs() + T(2) * h_y * at_y;
    const Four<T> size = there + w * (x.abs() + (z * slope_x).abs() + e * half_w + f.abs() * half_h) +
                         h * (y.abs() + (z * slope_y).abs() + f.abs() * half_w + g * half_h);
    const Four<T> plane2 = there - less_x - less_y - loss<T> * size;
    return (plane2.max(T(0)).sqrt() - play).max(T(0)).square();
  }
  // Where the distance falls all along an axis there is no minimum, except on the border. So the cells around
  // the piece count too, a quarter more on both sides at most; there and here slopes differ from the plane's
  // by `spread` at most.
  unsigned without_minimum(const Four<T>& spread_x, const Four<T>& spread_y) const {
    const Four<T> rise = play + w * (T(0.75) * slope_x.abs() + T(0.25) * spread_x) +
                         h * (T(0.75) * slope_y.abs() + T(0.25) * spread_y);
    const auto falls = [&](const Four<T>& at, T size, const Four<T>& slope, const Four<T>& spread) {
      const Four<T> tilt = z * slope;
      return less<T>(T(0.75) * size + z.abs() * spread + rise * (slope.abs() + spread) +
                         loss<T> * (at.abs() + tilt.abs()),
                     (at + tilt).abs());
    };
    return falls(x, w, slope_x, spread_x) | falls(y, h, slope_y, spread_y);
  }
};

// What of some boxes is nearer than a reach, and whether that is in a cone.
template <class T>
class Reached {
 public:
  Reached(const Boxes<T>& boxes, T reach) {
    const Four<T> z = boxes.z0.max(-boxes.z1).max(T(0));
    const Four<T> wide2 = reach * reach - z * z;
    const Four<T> wide = wide2.max(T(0)).sqrt();
    x0_ = boxes.x0.max(-wide);
    x1_ = boxes.x1.min(wide);
    y0_ = boxes.y0.max(-wide);
    y1_ = boxes.y1.min(wide);
    z0_ = boxes.z0.max(-reach);
    z1_ = boxes.z1.min(reach);
    reach_ = reach;
    far_ = (x0_.square().max(x1_.square()) + y0_.square().max(y1_.square()) + z0_.square().max(z1_.square()))
               .sqrt()
               .min(reach);
    nothing_ = less<T>(wide2, Four<T>::Zero()) | less<T>(x1_, x0_) | less<T>(y1_, y0_);
  }

  // Bit k: nothing of piece k is both within reach and outside of the cone.
  unsigned boxes_in_cone(const Vec3& axis, double cosine) const {
    const T x = T(axis.x()), y = T(axis.y()), z = T(axis.z());
    const Four<T> least = least_of(x, x0_, x1_) + least_of(y, y0_, y1_) + least_of(z, z0_, z1_);
    return nothing_ | less<T>(T(cosine) * far_ + loss<T> * reach_, least);
  }
  unsigned planes_in_cone(const TiltedPieces<T>& p, const Vec3& axis, double cosine) const {
    const T x = T(axis.x()), y = T(axis.y()), z = T(axis.z());
    const Four<T> aside = p.x * p.slope_x, behind = p.y * p.slope_y;
    const Four<T> least = z * (p.z - aside - behind) - std::abs(z) * p.play +
                          least_of(x + z * p.slope_x, x0_, x1_) + least_of(y + z * p.slope_y, y0_, y1_);
    const Four<T> size =
        reach_ * (T(1) + p.slope_x.abs() + p.slope_y.abs()) + p.z.abs() + aside.abs() + behind.abs();
    return nothing_ | less<T>(T(cosine) * far_ + loss<T> * size, least);
  }

 private:
  template <class K>
  static Four<T> least_of(const K& k, const Four<T>& low, const Four<T>& high) {
    return (k * low).min(k * high);
  }

  Four<T> x0_, x1_, y0_, y1_, z0_, z1_, far_;
  T reach_;
  unsigned nothing_;
};

}  // namespace intaglio::surface
