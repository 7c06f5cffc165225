// The report of a session: one page that shows, to eyes alone, that the senses agree.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "session/recording.h"

namespace intaglio::report {

// A self-contained HTML page: video (may be empty), key frames, what was seen, felt, moved and heard on one
// time axis, how well these agree, and what they cost. Valid for any recording, also an empty one or one that
// holds not-a-number: what cannot be told is "–". Some megabytes beside the video; takes about a second for
// ten of audio.
std::string report_html(const session::Recording& recording, std::span<const std::uint8_t> video_mp4);

// The report's tables: what each sense cost, figures of the run, and the voices.

std::string cost_table(const session::Recording& recording);
std::string run_table(const session::Recording& recording);
std::string voice_table(const session::Recording& recording);

}  // namespace intaglio::report
