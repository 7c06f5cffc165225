// Pages for people: what was seen, felt, heard and moved, on one time axis, and how well the senses agree.
//
//   intaglio::save_report(*recording, "brick.html");                  // examples/simulate_scene.cpp
//
// Self-contained HTML, except that a video of more than 150 MB is linked. Takes about a second for a minute
// of audio; any thread.
#pragma once

#include <filesystem>
#include <string>

#include "intaglio/error.h"
#include "intaglio/session.h"

namespace intaglio {

struct ReportOptions {
  std::filesystem::path video = {};  // an MP4 to put into the page (Recording::save_video); empty: none
};

Result<void> save_report(const Recording& recording, const std::filesystem::path& html,
                         const ReportOptions& options = {});

// A texture in numbers: its conventions, depth, slopes, terraces, whether its normals fit a height, and
// which representation suits it. `texture` as Surface::load takes it.
Result<void> save_texture_page(const std::filesystem::path& texture, const std::filesystem::path& html);
Result<std::string> texture_json(const std::filesystem::path& texture);  // the same figures, for programs

}  // namespace intaglio
