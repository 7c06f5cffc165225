// When within a step a contact touched: kept in two numbers of Bullet's point that only cached friction uses.
//
// Internal to dynamics/: includes Bullet.
#pragma once

#include <BulletCollision/NarrowPhaseCollision/btManifoldPoint.h>

#include <optional>

namespace intaglio::dynamics {

// `delay`: s after the step's start; less than 0 for one that is resolved a step late.
inline void set_touch(btManifoldPoint& point, std::optional<double> delay) {
  point.m_contactMotion1 = static_cast<btScalar>(delay.value_or(0));
  point.m_contactMotion2 = delay ? 1 : 0;
}
inline std::optional<double> touch_of(const btManifoldPoint& point) {
  if (point.m_contactMotion2 == 0) return std::nullopt;
  return static_cast<double>(point.m_contactMotion1);
}

}  // namespace intaglio::dynamics
