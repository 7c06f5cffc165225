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
  // Point i's share of the step's impulse; the shares add up to 1.
  double impulse_share(std::size_t i) const;
  // The point with the largest impulse, and the one nearest to a place in the world.
  const ContactEvent& main_point() const;
  const ContactEvent& nearest_point(const Vec3& place) const;
  // Fraction of the step at which the earliest new contact began, among new points that carry at least a
  // third of the impulse.
  std::optional<double> first_touch() const;
};

// Splits the impulses that an engine reports, step after step, for one pair of bodies into a sustained part
// and onsets (§1.3.3).
//
// A body at rest has an impulse in every step, and played as they are these would buzz at the engine's step
// rate. So only onsets strike. With J_k the impulse of step k and S_k its sustained part, the part that the
// step before had as well,
//
//   S_k   = clamp(J_k . J_(k-1) / |J_(k-1)|^2, 0, 1) J_(k-1)
//   onset = J_k - S_k - max(0, 1 - |S_k| / |S_(k-1)|) S_(k-1).
//
// The last term is the release: when the sustained part falls, because the body lifts off, the loss strikes
// backwards.
//   steady  J, J, J, ...   S = J, onset 0: silent
//   bounce  0, J, 0        onsets 0, J, 0: one blow, where the difference J_k - J_(k-1) would be two opposite
//                          ones a step apart, a comb filter
//   weight  0, J, J, 0     onsets 0, J, 0, -J: setting it down and lifting it off sound alike
// Scaling all impulses scales the onsets; sums of impulses do not give sums of onsets. One object per pair,
// one thread.

class ImpulseSplitter {
 public:
  // A change smaller than `dead_band` times the sustained part is the solver's noise and does not sound.
  explicit ImpulseSplitter(double dead_band = 1e-3) : dead_band_(dead_band) {}

  // Takes J_k (N s) and returns the onset of this step. A step without contact is J_k = 0.
  Vec3 split(const Vec3& impulse);
  // S_k, after the last step.
  const Vec3& sustained() const { return sustained_; }

 private:
  double dead_band_;
  Vec3 previous_ = Vec3::Zero();
  Vec3 sustained_ = Vec3::Zero();
};

}  // namespace intaglio::sound
