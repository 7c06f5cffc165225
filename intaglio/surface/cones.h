// The directions around features already found, as seen from the asking point: what lies in them is not
// wanted again. Internal to surface/; on the stack, no allocation.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "intaglio/core/elementary.h"
#include "intaglio/core/vec.h"
#include "intaglio/surface/closest.h"

namespace intaglio::surface {

class Cones {
 public:
  // `sign` is 1 for an asking point above the relief, -1 below; min_angle in radians.
  Cones(std::span<const Feature> found, double sign, double min_angle)
      : found_(found), sign_(sign), cos_(elementary::cos(min_angle)), sin_(elementary::sin(min_angle)) {}

  bool empty() const { return found_.empty(); }
  std::size_t size() const { return found_.size(); }
  double cosine() const { return cos_; }
  Vec3 axis(std::size_t k) const { return -sign_ * found_[k].direction; }  // from the asking point

  // Whether a feature of this direction is in one.
  bool hold(const Vec3& direction) const {
    return std::any_of(found_.begin(), found_.end(),
                       [&](const Feature& f) { return f.direction.dot(direction) > cos_; });
  }
  // Whether a ball, its centre as seen from the asking point, is wholly within one cone. False when that is
  // not certain.
  bool hold_ball(const Vec3& centre, double radius) const {
    const double distance2 = centre.squaredNorm();
    // The ball looks asin(radius / distance) wide, and its centre must be that much inside the cone;
    // min_angle < 90 degrees.
    if (cos_ <= 0 || radius * radius >= sin_ * sin_ * distance2) return false;
    // distance * cos(min_angle - asin(radius / distance))
    const double needed = cos_ * std::sqrt(distance2 - radius * radius) + sin_ * radius;
    return std::any_of(found_.begin(), found_.end(),
                       [&](const Feature& f) { return -sign_ * f.direction.dot(centre) > needed; });
  }

 private:
  std::span<const Feature> found_;
  double sign_, cos_, sin_;
};

}  // namespace intaglio::surface
