// "Felt", "Moved" and "Heard" over time: plots that lie under each other like the tracks of a mixing desk.
//
// All have the same width and the same time axis, so that one instant is one vertical line through all of
// them. Faint lines mark the strongest impacts.
#pragma once

#include <string>

#include "session/recording.h"
#include "report/svg_plot.h"

namespace intaglio::report {

inline constexpr double track_width = 1100;     // drawing units, of every track
inline constexpr Range track_area = {76, 976};  // of these, what the time axis takes

inline constexpr double track_axis_height = 30;  // of the time axis, below the lowest panel
inline constexpr int track_time_ticks = 12;

// Seconds to drawing units: the one mapping of every track.
Axis time_axis(const session::Recording& recording);
// Vertical lines at the strongest impacts, through all panels of a track.
void draw_impacts(SvgPlot& plot, const session::Recording& recording, double top, double bottom);

// Height of pen and surface, force. A sentence when there was no pen.
std::string felt_html(const session::Recording& recording);
// Height and speed of the balls. A sentence when there were none.
std::string moved_html(const session::Recording& recording);
// Contacts, spectrogram with the baked modes beside it, waveform. A sentence when there is no audio.
std::string heard_html(const session::Recording& recording);

}  // namespace intaglio::report
