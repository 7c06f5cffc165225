// When within the step ahead a body's contacts close, and which of them bounce in it.
//
// Internal to dynamics/: includes Bullet.
#pragma once

#include <algorithm>
#include <array>
#include <optional>

#include "intaglio/dynamics/approach.h"

namespace intaglio::dynamics {

// m/s: what touches no faster is gravity's doing in a step of `dt` s, and would chatter if it bounced.
inline double least_bounce(double gravity, double dt) {
  return std::max(0.02, gravity * dt);
}
// Bullet sees the speed before the step, to which gravity adds: of what bounces, more than this.
inline double least_seen(double least) {
  return 0.25 * least;
}

// What Bullet is told of a contact.
struct Meeting {
  bool waits = false;           // it bounces, but in a later step
  double distance = 0;          // m; what is only met later is no overlap to undo
  double restitution = 0;       // of the speed with which Bullet sees it close
  std::optional<double> touch;  // s after the step's start, of one that closes; < 0: it is resolved late
};
using Meetings = std::array<Meeting, contact::ContactSet::capacity>;

// A contact bounces when it touches faster than `least` m/s. Bullet brakes what is ahead softly, and its
// restitution is lost; so what bounces is resolved once, at full speed, in whichever step starts nearest to
// its touch, with the energy that it has left then. A ball that meets two things one after the other meets
// the second with what speed the first leaves it, and both are timed by the first. Other bodies, which a
// blow also turns, meet all at once.
Meetings meetings(const Ahead& contacts, const Approach& approach, double restitution, double least,
                  double slack);

}  // namespace intaglio::dynamics
