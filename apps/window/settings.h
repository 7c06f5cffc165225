// Window settings, addressable by name: saved between runs, changed by panels and scripts. Plain values.
//
// The file is TOML, $XDG_CONFIG_HOME/intaglio/window.toml or ~/.config/intaglio/window.toml. An unreadable
// file is reported and left unchanged; defaults apply.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "intaglio/error.h"
#include "scene/cues.h"

namespace intaglio::window {

struct Settings {
  // Saved between runs.
  int width = 1280, height = 720;
  double interface_scale = 0;  // 0: from the display
  double volume = 0;           // dB
  bool mute = false;
  bool panels = true, overlay_contacts = true, overlay_normals = false, overlay_pen = true;
  bool overlay_timing = true, overlay_scope = true;
  bool rumble = true;
  double min_frame_rate = 20;  // frames/s, below which the resolution is lowered
  int samples = 1;             // per pixel side

  // For this run only.
  bool paused = false;
  double speed = 1;
  bool pen = false;  // the mouse moves the pen
  bool sees = true, moves = true, feels = true, hears = true;
  int representation = -1;  // 0 flat, 1 normal, 2 relief; -1: scene default
  int mesh = 0;             // > 0: relief as a displaced mesh of so many squares a side; 0: traced
  bool classic = false;     // traced by 32 linear and 6 binary steps
  double depth = -1;        // m; below 0: scene default
  double stiffness = -1;    // N/m; below 0: scene default
  bool use_paper_method = false;
  // Cues in the order of scene::Cue; unset: as the scene says.
  std::array<std::optional<scene::CueSettings>, scene::all_cues.size()> cues;
  std::string material;       // of the floor; empty: scene default
  std::string device;         // the pen: NAME@HOST[:PORT] of a VRPN device; empty: the mouse
  std::string device_source;  // "file:line" of the script that set it, for errors; empty: no script
};

// A named number or switch of the settings.
struct Setting {
  const char* name;
  double low, high;
  bool is_integer;            // switches: 0 and 1
  bool allows_scene_default;  // -1 means the scene's value
  bool is_saved;
  double (*get)(const Settings&);
  void (*set)(Settings&, double);
};
const std::vector<Setting>& all_settings();
// An error if there is no setting of that name, or the value is out of its range.
Result<void> check_setting(const std::string& name, double value);
// Checks, then sets.
Result<void> set_by_name(Settings& settings, const std::string& name, double value);

// The user's XDG folders; empty when there is no home.
std::filesystem::path config_folder();
std::filesystem::path cache_folder();

// Settings from the text of the file; `name` is the file's in errors, which say the line. An error changes
// nothing.
Result<void> parse_settings(std::string_view text, const std::string& name, Settings& settings);
Result<void> read_settings(const std::filesystem::path& file, Settings& settings);
Result<void> write_settings(const std::filesystem::path& file, const Settings& settings);

}  // namespace intaglio::window
