// The touches of a recording that can be heard: contacts that begin, and edges met within one, as blows.
//
// A body that slides or rolls touches without a pause, and what strikes is what is new in the impulse of a
// step (sound/contact_force.h). Any thread.
#pragma once

#include <span>
#include <vector>

#include "intaglio/session/recording.h"

namespace intaglio::session {

struct Touch {
  static constexpr double apart = 0.005;  // s, within which the blows of one pair are one: the strongest
  static constexpr double least =
      0.02;  // of the strongest blow of its body: light ones strike as bright as heavy

  double time = 0;     // s, of the touch where it is known, else the middle of its step
  BodyId body = 0;     // who touches
  double impulse = 0;  // N s, what is new
};

// In order of time, all at least `least` of their body's strongest.
std::vector<Touch> touches_of(const Recording& recording);

// Those that must be heard: at least a tenth of their body's strongest, and not masked, twice as strong as
// all touches of the 100 ms before.
std::vector<Touch> unmasked(std::span<const Touch> touches);

}  // namespace intaglio::session
