// A page on which every built-in texture can be heard: struck, scraped and rolled on, with spectrograms; and
// the scenes behind it.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "intaglio/error.h"
#include "scene/scene.h"

namespace intaglio::report {

enum class TouchKind { strike, scrape, roll };
inline constexpr std::array touch_kinds{TouchKind::strike, TouchKind::scrape, TouchKind::roll};
std::string touch_name(TouchKind touch);  // "strike", "scrape", "roll"

// A slab of 50 x 50 x 3 cm with the texture on it. Strike: a wooden ball of 1 cm radius falls on it from 1
// cm. Scrape: a wooden pen is dragged over it at 15 cm/s. Roll: a steel ball of 1 cm radius rolls over it at
// 0.6 m/s. The ears are half a metre away. `texture` as in a scene file: a built-in name, a recipe, an image
// or a folder.
scene::Scene touch_scene(TouchKind touch, const std::string& texture);

struct SoundPageJob {
  std::filesystem::path folder;       // receives index.html, and one .mp3 and .png per sound
  std::vector<std::string> textures;  // empty: all built-in ones
  bool quiet = false;
};

// All textures are checked first. All files appear together at the end; on failure the old ones stay. About
// 2 s of CPU time per sound. Sounds are peak-normalised; the page states the true level.
Result<void> make_sound_page(const SoundPageJob& job);

}  // namespace intaglio::report
