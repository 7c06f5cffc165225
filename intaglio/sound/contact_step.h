// All contact points of one pair of bodies in one step of the engine that reports them.
//
// Internal to sound/. SI units, world frame. Nothing here allocates.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "intaglio/core/event.h"

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

}  // namespace intaglio::sound
