// Impacts, contact intervals, body names and the plots' duration, extracted from a recording.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "session/recording.h"

namespace intaglio::report {

struct TimeSpan {
  double begin = 0;  // s
  double end = 0;    // s
};

// An impact of a ball. Contacts that begin within 10 ms count as one: a ball may touch at several points.
struct Impact {
  double time = 0;  // s, of its first contact
  BodyId body = 0;
  double impulse = 0;  // N s, over its first 10 ms
};

// Duration of the time axis, s: the recording's, or that of its longest series, or 1. Finite and positive.
double shown_duration(const session::Recording& recording);

// Those of all balls, in order of time.
std::vector<Impact> find_impacts(const session::Recording& recording);

// The strongest `count` that are at least a tenth of the greatest and `apart` seconds from a stronger one; in
// order of time.
std::vector<Impact> strongest(std::vector<Impact> impacts, std::size_t count, double apart);

// The voice's name, otherwise "floor", "pen" or "ball 3".
std::string body_name(const session::Recording& recording, BodyId body);

// When the pen touches.
std::vector<TimeSpan> pen_touches(const session::Recording& recording);

// Sorted union of the spans, clipped to [0, duration].
std::vector<TimeSpan> merged(std::vector<TimeSpan> spans, double duration);
double total_duration(std::span<const TimeSpan> spans);

// "Seen": the height map from above, with the paths of balls and pen; a close-up of where the pen touched if
// that is a small part of it; a legend. A placeholder sentence without a surface.
std::string seen_html(const session::Recording& recording);

}  // namespace intaglio::report
