// Where a texture lies in the world: a rectangle.
//
// Three frames are used for a textured rectangle:
//   uv      (u, v) in 0..1; u to the right of the image, v **up** the image (v = 0 is the bottom row)
//   local   (x, y, z) in metres along (t, b, n), from the corner u = v = 0; z = 0 is the base plane and the
//   relief is at z = -depth world   metres
#pragma once

#include "intaglio/core/vec.h"

namespace intaglio::surface {

class Placement {
 public:
  // A rectangle of size_u x size_v metres whose middle is at `centre`, lying flat in the world when
  // `orientation` is the identity: t = +X, b = -Z, n = +Y.
  Placement(const Vec3& centre, const Quat& orientation, double size_u, double size_v)
      : size_u_(size_u), size_v_(size_v) {
    axes_.col(0) = orientation * Vec3::UnitX();
    axes_.col(1) = orientation * -Vec3::UnitZ();
    axes_.col(2) = orientation * Vec3::UnitY();
    corner_ = centre - 0.5 * size_u * t() - 0.5 * size_v * b();
  }

  double size_u() const { return size_u_; }
  double size_v() const { return size_v_; }
  Vec2 size() const { return {size_u_, size_v_}; }
  Vec3 t() const { return axes_.col(0); }
  Vec3 b() const { return axes_.col(1); }
  Vec3 n() const { return axes_.col(2); }

  Vec3 to_local(const Vec3& world) const { return axes_.transpose() * (world - corner_); }
  Vec3 to_world(const Vec3& local) const { return corner_ + axes_ * local; }
  Vec3 direction_to_local(const Vec3& world) const { return axes_.transpose() * world; }
  Vec3 direction_to_world(const Vec3& local) const { return axes_ * local; }
  Vec2 uv(const Vec3& local) const { return {local.x() / size_u_, local.y() / size_v_}; }
  // Whether a local point is over (or under) the rectangle, or beside it by `slack` metres at most.
  bool covers(const Vec3& local, double slack = 0) const {
    return local.x() >= -slack && local.x() <= size_u_ + slack && local.y() >= -slack &&
           local.y() <= size_v_ + slack;
  }

 private:
  double size_u_, size_v_;
  Mat3 axes_;  // columns t, b, n
  Vec3 corner_;
};

}  // namespace intaglio::surface
