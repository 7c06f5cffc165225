#include "intaglio/sound/contact_force.h"

#include <algorithm>

namespace intaglio::sound {

Vec3 ContactForce::step(const Vec3& impulse) {
  const double before = previous_.squaredNorm();
  const double common = before > 0 ? std::clamp(impulse.dot(previous_) / before, 0.0, 1.0) : 0.0;
  const Vec3 lasting = common * previous_;
  Vec3 blow = impulse - lasting;
  const double lasted = lasting_.norm();
  if (lasting.norm() < lasted) blow -= (1 - lasting.norm() / lasted) * lasting_;
  if (blow.norm() <= dead_band_ * std::max(lasting.norm(), lasted)) blow.setZero();
  previous_ = impulse;
  lasting_ = lasting;
  return blow;
}

}  // namespace intaglio::sound
