// The report of a session: one page that shows how well the senses agree.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "intaglio/error.h"
#include "report/axis.h"
#include "report/digest.h"

namespace intaglio::report {

// The session's video as a page shows it.
struct PageVideo {
  std::filesystem::path file = {};  // an MP4; empty: no video
  std::string link = {};            // how the page reaches it, where it is too large to be in the page
  std::uintmax_t most_embedded = 150'000'000;  // bytes; in the page they become a third more
};

// Writes an HTML page piece by piece to `out`: video, key frames, what was seen, felt, moved and heard on one
// time axis, how well these agree, and what they cost. Self-contained, but for a video that is too large.
// Valid for any session, including an empty one or one with NaN, which prints as "–". Some megabytes besides
// the video. Errors: the video cannot be read.
Result<void> write_report(const Digest& digest, const PageVideo& video,
                          const std::function<void(std::string_view)>& out);

// The report's tables: cost of each sense, figures of the run, voices.

std::string cost_table(const session::Run& run);
std::string run_table(const Digest& digest);
std::string voice_table(const session::Run& run);

// "Felt", "Moved" and "Heard": time plots stacked like tracks in an audio editor.
//
// All share a width and a time axis, so that an instant is one vertical line. Faint lines mark the strongest
// impacts. Without data a track is a placeholder sentence.

inline constexpr double track_width = 1100;  // drawing units, of every track

// Height of pen and surface, force.
std::string felt_html(const Digest& digest);
// Height and speed of the balls.
std::string moved_html(const Digest& digest);
// Contacts, spectrogram with the baked modes beside it, waveform.
std::string heard_html(const Digest& digest);

}  // namespace intaglio::report
