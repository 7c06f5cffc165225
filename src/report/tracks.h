// "Felt", "Moved" and "Heard": time plots stacked like tracks in an audio editor.
//
// All share a width and a time axis, so that an instant is one vertical line. Faint lines mark the strongest
// impacts. Without data a track is a placeholder sentence.
#pragma once

#include <string>

#include "session/recording.h"
#include "report/svg_plot.h"

namespace intaglio::report {

inline constexpr double track_width = 1100;     // drawing units, of every track
inline constexpr Range track_area = {76, 976};  // drawing units, of the time axis

// Seconds to drawing units; shared by all tracks.
Axis time_axis(const session::Recording& recording);
// Vertical lines at the strongest impacts, through all panels of a track.
void draw_impacts(SvgPlot& plot, const session::Recording& recording, double top, double bottom);

// Height of pen and surface, force.
std::string felt_html(const session::Recording& recording);
// Height and speed of the balls.
std::string moved_html(const session::Recording& recording);
// Contacts, spectrogram with the baked modes beside it, waveform.
std::string heard_html(const session::Recording& recording);

}  // namespace intaglio::report
