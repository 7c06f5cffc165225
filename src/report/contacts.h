// What the report takes from a recording: who takes part, impacts, touching intervals, and the span of time
// that it draws.
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

// A ball that comes down on the surface. Begins within 10 ms of each other are one impact: a ball may touch
// at several points.
struct Impact {
  double time = 0;  // s, of its first contact
  BodyId body = 0;
  double impulse = 0;  // N s, over its first 10 ms
};

// Seconds that the time plots show: the recording's duration, or of its longest series, or 1. Always finite
// and positive.
double shown_duration(const session::Recording& recording);

// Of all balls, in order of time.
std::vector<Impact> impacts_of(const session::Recording& recording);

// The strongest `count` that are at least a tenth of the greatest and `apart` seconds from a stronger one; in
// order of time.
std::vector<Impact> strongest(std::vector<Impact> impacts, std::size_t count, double apart);

// As its voice is called, else "floor", "pen" or "ball 3".
std::string body_name(const session::Recording& recording, BodyId body);

// When the pen touches.
std::vector<TimeSpan> pen_touches(const session::Recording& recording);

// Overlapping spans joined, all within 0..duration.
std::vector<TimeSpan> joined(std::vector<TimeSpan> spans, double duration);
double total_seconds(std::span<const TimeSpan> spans);

// "Seen": the surface from above, as a height map, with the ways that balls and pen took over it.

// The whole surface, a close-up of where the pen touched when that is a small part of it, and the key. A
// sentence when there is no surface.
std::string seen_html(const session::Recording& recording);

}  // namespace intaglio::report
