#include "window/settings.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>

#include "core/file.h"
#include "core/text.h"
#include "core/toml.h"

namespace intaglio::window {

namespace fs = std::filesystem;

namespace {

// What a setting can be.
struct Values {
  double low = 0, high = 1;
  bool is_whole = true, has_scenes = false;
};
constexpr Values a_switch;

// A setting that is the member itself.
template <auto member>
Setting direct(const char* name, const Values& values, bool is_kept) {
  return {name,
          values.low,
          values.high,
          values.is_whole,
          values.has_scenes,
          is_kept,
          [](const Settings& s) { return static_cast<double>(s.*member); },
          [](Settings& s, double value) {
            using T = std::remove_reference_t<decltype(s.*member)>;
            if constexpr (std::is_same_v<T, bool>) {
              s.*member = value != 0;
            } else {
              s.*member = static_cast<T>(value);
            }
          }};
}

fs::path folder(const char* variable, const char* below_home) {
  if (const char* set = std::getenv(variable); set != nullptr && set[0] == '/')
    return fs::path(set) / "intaglio";
  if (const char* home = std::getenv("HOME"); home != nullptr && home[0] == '/')
    return fs::path(home) / below_home / "intaglio";
  return {};
}

}  // namespace

const std::vector<Setting>& settings_by_name() {
  static const std::vector<Setting> all = {
      direct<&Settings::width>("width", {16, 7680}, true),
      direct<&Settings::height>("height", {16, 4320}, true),
      direct<&Settings::interface_scale>("interface_scale", {0, 4, false}, true),
      direct<&Settings::volume>("volume", {-120, 60, false}, true),
      direct<&Settings::mute>("mute", a_switch, true),
      direct<&Settings::panels>("panels", a_switch, true),
      direct<&Settings::overlay_contacts>("contacts", a_switch, true),
      direct<&Settings::overlay_normals>("normals", a_switch, true),
      direct<&Settings::overlay_pen>("pen_force", a_switch, true),
      direct<&Settings::overlay_timing>("timing", a_switch, true),
      direct<&Settings::overlay_scope>("scope", a_switch, true),
      direct<&Settings::rumble>("rumble", a_switch, true),
      direct<&Settings::least_rate>("least_rate", {1, 240, false}, true),
      direct<&Settings::samples>("samples", {1, 4}, true),
      direct<&Settings::paused>("paused", a_switch, false),
      direct<&Settings::speed>("speed", {0.01, 1, false}, false),
      direct<&Settings::pen>("pen", a_switch, false),
      direct<&Settings::sees>("sees", a_switch, false),
      direct<&Settings::moves>("moves", a_switch, false),
      direct<&Settings::feels>("feels", a_switch, false),
      direct<&Settings::hears>("hears", a_switch, false),
      direct<&Settings::representation>("representation", {0, 2, true, true}, false),
      direct<&Settings::mesh>("mesh", {0, 1024}, false),
      direct<&Settings::classic>("classic", a_switch, false),
      direct<&Settings::depth>("depth", {0, 10, false, true}, false),
      direct<&Settings::stiffness>("stiffness", {0, 1e5, false, true}, false),
      direct<&Settings::papers_method>("papers_method", a_switch, false),
  };
  return all;
}

namespace {

const Setting* find(const std::string& name) {
  for (const Setting& setting : settings_by_name())
    if (name == setting.name) return &setting;
  return nullptr;
}

}  // namespace

Result<void> check_setting(const std::string& name, double value) {
  const Setting* const setting = find(name);
  if (setting == nullptr) {
    std::vector<std::string> names;
    for (const Setting& known : settings_by_name()) names.emplace_back(known.name);
    const std::string nearest = nearest_name(name, names);
    return fail("", fmt::format("there is no setting \"{}\"", name),
                nearest.empty() ? fmt::format("known: {}", fmt::join(names, ", "))
                                : fmt::format("did you mean \"{}\"?", nearest));
  }
  const bool is_scenes = setting->has_scenes && value == -1;
  const bool is_within = value >= setting->low && value <= setting->high;
  if (is_scenes || (is_within && (!setting->is_whole || value == std::floor(value)))) return {};
  return fail("", fmt::format("{} is {}", name, value),
              fmt::format("it must be {} {} {} {}{}", setting->is_whole ? "a whole number from" : "between",
                          setting->low, setting->is_whole ? "to" : "and", setting->high,
                          setting->has_scenes ? ", or -1 for the scene's own" : ""));
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
  const auto bytes = read_file(file, 1u << 20);
  if (!bytes) return tl::unexpected(bytes.error());
  const auto table = parse_toml({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, file.string());
  if (!table) return tl::unexpected(table.error());
  std::optional<Error> error;
  TomlReader reader(*table, file.string(), "", error);
  Settings read = settings;
  for (const Setting& setting : settings_by_name()) {
    if (!setting.is_kept) continue;
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
  for (const Setting& setting : settings_by_name())
    if (setting.is_kept)
      text += fmt::format("{} = {}\n", setting.name,
                          std::clamp(setting.get(settings), setting.low, setting.high));
  return write_file(file, text);
}

}  // namespace intaglio::window
