// The report of a session: one page that shows how well the senses agree.
#pragma once

#include <cstdint>
#include <span>
#include <string>

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

}  // namespace intaglio::report
