// A page on which every built-in texture can be heard: struck, scraped and rolled on, with spectrograms.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "intaglio/core/error.h"

namespace intaglio::session {

struct SoundPageJob {
  std::filesystem::path folder;       // gets index.html, and an .mp3 and a .png each
  std::vector<std::string> textures;  // empty: all built-in ones
  bool quiet = false;
};

// Every texture is looked at before a sound is made; when something fails nothing is left behind. Some 2 s of
// CPU time a sound. Sounds are brought to one peak level; the page names the true one.
Result<void> make_sound_page(const SoundPageJob& job);

}  // namespace intaglio::session
