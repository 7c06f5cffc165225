// What is new in the impulses that a physics engine reports, step after step, for one pair of bodies
// (§1.3.3).
//
// A body at rest has an impulse in every step, and played as they are these would drone at the rate of the
// engine. So the impulse J_k of a step is split into what lasts, S_k, the part that the step before had as
// well, and what is new, J_k - S_k; only the new part strikes. When what lasted falls, because the body lifts
// off, the loss strikes the other way. A bounce is thus one blow, where the plain difference J_k - J_(k-1)
// would make it two opposite ones a step apart, a comb filter; a steady force is silent; and setting a weight
// down and lifting it off sound alike. Linear in the impulses (N s). One object a pair, one thread.
#pragma once

#include "intaglio/core/vec.h"

namespace intaglio::sound {

class ContactForce {
 public:
  // A change smaller than `dead_band` times what lasts is the solver's noise and does not sound.
  explicit ContactForce(double dead_band = 1e-3) : dead_band_(dead_band) {}

  // Takes J_k and returns the blow of this step. A step without contact is J_k = 0.
  Vec3 step(const Vec3& impulse);
  // S_k, after the last step.
  const Vec3& lasting() const { return lasting_; }

 private:
  double dead_band_;
  Vec3 previous_ = Vec3::Zero();
  Vec3 lasting_ = Vec3::Zero();
};

}  // namespace intaglio::sound
