// What the user chose in the window, by name: kept between runs, set by panels and by scripts. Plain values.
//
// The file is TOML, $XDG_CONFIG_HOME/intaglio/window.toml or ~/.config/intaglio/window.toml. A file that
// cannot be read is left alone, said in one line, and the defaults hold.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "intaglio/error.h"

namespace intaglio::window {

struct Settings {
  // Kept between runs.
  int width = 1280, height = 720;
  double interface_scale = 0;  // 0: by the screen
  double volume = 0;           // dB
  bool mute = false;
  bool panels = true, overlay_contacts = true, overlay_normals = false, overlay_pen = true;
  bool overlay_timing = true, overlay_scope = true;
  bool rumble = true;
  double least_rate = 20;  // frames a second below which the picture is drawn coarser
  int samples = 1;         // along a side of a pixel

  // Of this run.
  bool paused = false;
  double speed = 1;
  bool pen = false;  // the mouse leads the pen
  bool sees = true, moves = true, feels = true, hears = true;
  int representation = -1;  // 0 flat, 1 normal, 2 relief; -1: the scene's
  int mesh = 0;             // relief as a displaced mesh of so many squares a side, to compare; 0: traced
  bool classic = false;     // traced by 32 linear and 6 binary steps, to compare
  double depth = -1;        // m; below 0: the scene's
  double stiffness = -1;    // N/m; below 0: the scene's
  bool papers_method = false;
  std::string material;     // of the floor; empty: the scene's
  std::string device;       // the pen: NAME@HOST[:PORT] of a VRPN device; empty: the mouse
  std::string device_from;  // "file:line" of the script that asked for it, for errors; empty: no script
};

// A named number or switch of the settings.
struct Setting {
  const char* name;
  double low, high;
  bool is_whole;    // 0 and 1 of a switch
  bool has_scenes;  // -1 stands for what the scene says
  bool is_kept;
  double (*get)(const Settings&);
  void (*set)(Settings&, double);
};
const std::vector<Setting>& settings_by_name();
// Whether there is a setting of that name which can have this value; if not, what would be right.
Result<void> check_setting(const std::string& name, double value);
// Sets it, if it can be.
Result<void> set_by_name(Settings& settings, const std::string& name, double value);

// The folders of the user that XDG names; empty when there is no home.
std::filesystem::path config_folder();
std::filesystem::path cache_folder();

Result<void> read_settings(const std::filesystem::path& file, Settings& settings);
Result<void> write_settings(const std::filesystem::path& file, const Settings& settings);

}  // namespace intaglio::window
