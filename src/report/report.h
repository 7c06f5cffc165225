// The report of a session: one page that shows how well the senses agree.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "report/svg_plot.h"
#include "session/recording.h"

namespace intaglio::report {

// A self-contained HTML page: video (may be empty), key frames, what was seen, felt, moved and heard on one
// time axis, how well these agree, and what they cost. Valid for any recording, including an empty one or one
// with NaN, which prints as "–". Some megabytes besides the video; takes about a second per ten of audio.
std::string report_html(const session::Recording& recording, std::span<const std::uint8_t> video_mp4);

// The report's tables: cost of each sense, figures of the run, voices.

std::string cost_table(const session::Recording& recording);
std::string run_table(const session::Recording& recording);
std::string voice_table(const session::Recording& recording);

// "Felt", "Moved" and "Heard": time plots stacked like tracks in an audio editor.
//
// All share a width and a time axis, so that an instant is one vertical line. Faint lines mark the strongest
// impacts. Without data a track is a placeholder sentence.

inline constexpr double track_width = 1100;     // drawing units, of every track
inline constexpr Range track_area = {76, 976};  // drawing units, of the time axis

// Seconds to drawing units; shared by all tracks.
Axis time_axis(const session::Recording& recording);

// Height of pen and surface, force.
std::string felt_html(const session::Recording& recording);
// Height and speed of the balls.
std::string moved_html(const session::Recording& recording);
// Contacts, spectrogram with the baked modes beside it, waveform.
std::string heard_html(const session::Recording& recording);

}  // namespace intaglio::report
