// Reads, plots and replays haptic logs.
#pragma once

#include <filesystem>
#include <string>

#include "haptics/haptic_log.h"
#include "scene/scene.h"

namespace intaglio::report {

Result<haptics::HapticLog> read_haptic_log(const std::filesystem::path& path);

// A short text summary: duration, texture, force, what the guard did.
std::string haptic_summary(const haptics::HapticLog& log);

// A self-contained page with height and force over time.
std::string haptic_page(const haptics::HapticLog& log, const std::string& title);

struct Replayed {
  double largest_difference = 0;  // N, of the forces recorded and replayed
  bool same_surface = false;      // the log's fingerprint is the scene's
};

// Replays the recorded device motion on the scene's floor and grounds, by the scene's method, without balls.
// Errors: the scene has no pen, its surface cannot be built, its servo rate is not the log's.
Result<Replayed> replay(const haptics::HapticLog& log, const scene::Scene& scene);

}  // namespace intaglio::report
