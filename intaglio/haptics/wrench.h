// A force and the torque that it has about a point: what the pen does to the hand.
//
// The torque is about the point that the wrench is named for (the grip), world frame, N and N m. Moving it to
// another point is exact; only differences of points occur, so that the world's origin does not matter.
#pragma once

#include "intaglio/core/vec.h"

namespace intaglio::haptics {

struct Wrench {
  Vec3 force = Vec3::Zero();   // N
  Vec3 torque = Vec3::Zero();  // N m

  // A force at `at`, felt about `about`.
  static Wrench of(const Vec3& force, const Vec3& at, const Vec3& about) {
    return {force, (at - about).cross(force)};
  }
  // The same wrench about another point: `step` from the old point to the new one.
  Wrench about(const Vec3& step) const { return {force, torque - step.cross(force)}; }

  Wrench& operator+=(const Wrench& other) {
    force += other.force;
    torque += other.torque;
    return *this;
  }
  bool is_finite() const { return force.allFinite() && torque.allFinite(); }
};

}  // namespace intaglio::haptics
