// All contact points of one pair of bodies in one step of the engine that reports them.
//
// Internal to sound/. SI units, world frame. Nothing here allocates.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "intaglio/event.h"
#include "intaglio/vec.h"

namespace intaglio::sound {

struct ContactStep {
  static constexpr std::size_t max_points = 8;

  double time = 0, duration = 0;  // s; it ends at `time`
  bool has_begin = false;
  std::array<ContactEvent, max_points> points;
  std::size_t count = 0;        // 0: no contact in this step
  Vec3 impulse = Vec3::Zero();  // N s, of all points, also of those beyond max_points
  double normal_impulse = 0;    // N s, along n_g

  double start() const { return time - duration; }
  void add(const ContactEvent& event);
  // How much of the step's impulse point i bears; all add up to 1.
  double share(std::size_t i) const;
  // The point that bears most, and the one nearest to `place`, world.
  const ContactEvent& main_point() const;
  // When the first of those points met what it touches that did not touch before and bear a third of the step
  // at least; 0..1 of the step.
  std::optional<double> touch() const;
  const ContactEvent& nearest_point(const Vec3& place) const;
};

// What is new in the impulses that a physics engine reports, step after step, for one pair of bodies
// (§1.3.3).
//
// A body at rest has an impulse in every step, and played as they are these would drone at the rate of the
// engine. So the impulse J_k of a step is split into what lasts, S_k, the part that the step before had as
// well, and what is new, J_k - S_k; only the new part strikes. When what lasted falls, because the body lifts
// off, the loss strikes the other way. A bounce is thus one blow, where the plain difference J_k - J_(k-1)
// would make it two opposite ones a step apart, a comb filter; a steady force is silent; and setting a weight
// down and lifting it off sound alike. Linear in the impulses (N s). One object a pair, one thread.

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
