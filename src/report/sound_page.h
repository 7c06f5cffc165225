// Scenes that let a texture be heard: struck, scraped and rolled on.
//
// A slab of half a metre with the texture on it. Struck: a steel ball of 2 cm radius falls 15 cm onto it.
// Scraped: a wooden pen is dragged over it at 15 cm/s. Rolled on: the ball rolls over it at 0.6 m/s. Ears
// are half a metre away.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"
#include "scene/scene.h"
#include "session/recording.h"

namespace intaglio::report {

enum class Touch { strike, scrape, roll };
inline constexpr std::array touches{Touch::strike, Touch::scrape, Touch::roll};
std::string touch_name(Touch touch);  // "strike", "scrape", "roll"

// `texture` as in a scene file: a built-in name, a recipe, an image or a folder.
scene::Scene touch_scene(Touch touch, const std::string& texture);

// Runs a scene without its picture. Seconds, mostly modal analysis.
Result<session::Recording> play(const scene::Scene& scene);

// A page on which every built-in texture can be heard: struck, scraped and rolled on, with spectrograms.

struct SoundPageJob {
  std::filesystem::path folder;       // gets index.html, and an .mp3 and a .png each
  std::vector<std::string> textures;  // empty: all built-in ones
  bool quiet = false;
};

// Every texture is looked at before a sound is made; when something fails nothing is left behind. Some 2 s of
// CPU time a sound. Sounds are brought to one peak level; the page names the true one.
Result<void> make_sound_page(const SoundPageJob& job);

}  // namespace intaglio::report
