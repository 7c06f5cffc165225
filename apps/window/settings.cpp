#include "window/settings.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/file.h"
#include "core/text.h"
#include "core/toml.h"

namespace intaglio::window {

namespace fs = std::filesystem;

namespace {

// Allowed range.
struct Range {
  double low = 0, high = 1;
  bool is_integer = true, allows_scene_default = false;
};
constexpr Range on_off;

// A setting that is the member itself.
template <auto member>
Setting direct(const char* name, const Range& range, bool is_saved) {
  return {name,
          range.low,
          range.high,
          range.is_integer,
          range.allows_scene_default,
          is_saved,
          [](const Settings& s) { return double(s.*member); },
          [](Settings& s, double value) {
            using T = std::remove_reference_t<decltype(s.*member)>;
            if constexpr (std::is_same_v<T, bool>) {
              s.*member = value != 0;
            } else {
              s.*member = static_cast<T>(value);
            }
          }};
}

// Four settings of a cue: whether it is on, its delay in ms, its shift along u and v in mm. Setting one that
// is unset starts from a true cue.
template <scene::Cue cue>
void add_cue(std::vector<Setting>& all, const std::array<const char*, 4>& names) {
  static constexpr auto at = std::size_t(cue);
  constexpr double delay = 1e3 * scene::max_cue_delay, shift = 1e3 * scene::max_cue_shift;
  using CueSettings = scene::CueSettings;
  static constexpr auto get = [](const Settings& s) { return s.cues[at].value_or(CueSettings()); };
  static constexpr auto change = [](Settings& s) -> CueSettings& {
    return s.cues[at] ? *s.cues[at] : s.cues[at].emplace();
  };
  all.push_back({names[0], 0, 1, true, false, false, [](const Settings& s) { return double(get(s).on); },
                 [](Settings& s, double value) { change(s).on = value != 0; }});
  all.push_back({names[1], 0, delay, false, false, false,
                 [](const Settings& s) { return 1e3 * get(s).delay; },
                 [](Settings& s, double value) { change(s).delay = 1e-3 * value; }});
  all.push_back({names[2], -shift, shift, false, false, false,
                 [](const Settings& s) { return 1e3 * get(s).shift.x(); },
                 [](Settings& s, double value) { change(s).shift.x() = 1e-3 * value; }});
  all.push_back({names[3], -shift, shift, false, false, false,
                 [](const Settings& s) { return 1e3 * get(s).shift.y(); },
                 [](Settings& s, double value) { change(s).shift.y() = 1e-3 * value; }});
}

fs::path folder(const char* variable, const char* below_home) {
  if (const char* set = std::getenv(variable); set != nullptr && set[0] == '/')
    return fs::path(set) / "intaglio";
  if (const char* home = std::getenv("HOME"); home != nullptr && home[0] == '/')
    return fs::path(home) / below_home / "intaglio";
  return {};
}

}  // namespace

namespace {

std::vector<Setting> make_settings() {
  std::vector<Setting> all = {
      direct<&Settings::width>("width", {16, 7680}, true),
      direct<&Settings::height>("height", {16, 4320}, true),
      direct<&Settings::interface_scale>("interface_scale", {0, 4, false}, true),
      direct<&Settings::volume>("volume", {-120, 60, false}, true),
      direct<&Settings::mute>("mute", on_off, true),
      direct<&Settings::panels>("panels", on_off, true),
      direct<&Settings::overlay_contacts>("contacts", on_off, true),
      direct<&Settings::overlay_normals>("normals", on_off, true),
      direct<&Settings::overlay_pen>("pen_force", on_off, true),
      direct<&Settings::overlay_timing>("timing", on_off, true),
      direct<&Settings::overlay_scope>("scope", on_off, true),
      direct<&Settings::rumble>("rumble", on_off, true),
      direct<&Settings::min_frame_rate>("least_rate", {1, 240, false}, true),
      direct<&Settings::samples>("samples", {1, 4}, true),
      direct<&Settings::paused>("paused", on_off, false),
      direct<&Settings::speed>("speed", {0.01, 1, false}, false),
      direct<&Settings::pen>("pen", on_off, false),
      direct<&Settings::sees>("sees", on_off, false),
      direct<&Settings::moves>("moves", on_off, false),
      direct<&Settings::feels>("feels", on_off, false),
      direct<&Settings::hears>("hears", on_off, false),
      direct<&Settings::representation>("representation", {0, 2, true, true}, false),
      direct<&Settings::mesh>("mesh", {0, 1024}, false),
      direct<&Settings::classic>("classic", on_off, false),
      direct<&Settings::depth>("depth", {0, 10, false, true}, false),
      direct<&Settings::stiffness>("stiffness", {0, 1e5, false, true}, false),
      direct<&Settings::use_paper_method>("papers_method", on_off, false),
  };
  add_cue<scene::Cue::picture>(all, {"picture_on", "picture_delay", "picture_shift", "picture_shift_v"});
  add_cue<scene::Cue::touch>(all, {"touch_on", "touch_delay", "touch_shift", "touch_shift_v"});
  add_cue<scene::Cue::pen_sound>(all,
                                 {"pen_sound_on", "pen_sound_delay", "pen_sound_shift", "pen_sound_shift_v"});
  add_cue<scene::Cue::ball_motion>(
      all, {"ball_motion_on", "ball_motion_delay", "ball_motion_shift", "ball_motion_shift_v"});
  add_cue<scene::Cue::ball_sound>(
      all, {"ball_sound_on", "ball_sound_delay", "ball_sound_shift", "ball_sound_shift_v"});
  return all;
}

}  // namespace

const std::vector<Setting>& all_settings() {
  static const std::vector<Setting> all = make_settings();
  return all;
}

namespace {

const Setting* find(const std::string& name) {
  for (const Setting& setting : all_settings())
    if (name == setting.name) return &setting;
  return nullptr;
}

}  // namespace

Result<void> check_setting(const std::string& name, double value) {
  const Setting* const setting = find(name);
  if (setting == nullptr) {
    std::vector<std::string> names;
    for (const Setting& known : all_settings()) names.emplace_back(known.name);
    const std::string nearest = nearest_name(name, names);
    return fail("", fmt::format("unknown setting \"{}\"", name),
                nearest.empty() ? fmt::format("known: {}", fmt::join(names, ", "))
                                : fmt::format("did you mean \"{}\"?", nearest));
  }
  const bool is_scenes = setting->allows_scene_default && value == -1;
  const bool is_within = value >= setting->low && value <= setting->high;
  if (is_scenes || (is_within && (!setting->is_integer || value == std::floor(value)))) return {};
  return fail("", fmt::format("{} is {}", name, value),
              fmt::format("it must be {} {} {} {}{}", setting->is_integer ? "an integer from" : "between",
                          setting->low, setting->is_integer ? "to" : "and", setting->high,
                          setting->allows_scene_default ? ", or -1 for the scene's value" : ""));
}

Result<void> set_by_name(Settings& settings, const std::string& name, double value) {
  auto checked = check_setting(name, value);
  if (checked) find(name)->set(settings, value);
  return checked;
}

fs::path config_folder() {
  return folder("XDG_CONFIG_HOME", ".config");
}
fs::path cache_folder() {
  return folder("XDG_CACHE_HOME", ".cache");
}

Result<void> read_settings(const fs::path& file, Settings& settings) {
  std::error_code ignored;
  if (file.empty() || !fs::exists(file, ignored)) return {};
  const auto text = read_text(file, 1u << 20);
  if (!text) return tl::unexpected(text.error());
  return parse_settings(*text, file.string(), settings);
}

Result<void> parse_settings(std::string_view text, const std::string& name, Settings& settings) {
  const auto table = parse_toml(text, name);
  if (!table) return tl::unexpected(table.error());
  std::optional<Error> error;
  TomlReader reader(*table, name, "", error);
  Settings read = settings;
  for (const Setting& setting : all_settings()) {
    if (!setting.is_saved) continue;
    double value = setting.get(read);
    reader.number(setting.name, value, {-1e4, 1e4, false, "a setting must be between -10000 and 10000"});
    if (auto set = set_by_name(read, setting.name, value); !set)
      reader.fail_at(setting.name, set.error().what, set.error().fix);
  }
  reader.finish();
  if (error) return tl::unexpected(*error);
  settings = read;
  return {};
}

Result<void> write_settings(const fs::path& file, const Settings& settings) {
  if (file.empty()) return {};
  std::string text = "# Written by intaglio run when its window is closed.\n";
  for (const Setting& setting : all_settings())
    if (setting.is_saved)
      text += fmt::format("{} = {}\n", setting.name,
                          std::clamp(setting.get(settings), setting.low, setting.high));
  return write_file(file, text);
}

}  // namespace intaglio::window
