#include "intaglio/window/settings.h"

#include <cmath>
#include <cstdlib>

#include "intaglio/core/file.h"
#include "intaglio/core/toml_reader.h"

namespace intaglio::window {

namespace fs = std::filesystem;

namespace {

// A setting that is the member itself.
template <auto member>
Setting direct(const char* name, bool is_kept) {
  return {name, is_kept, [](const Settings& s) { return static_cast<double>(s.*member); },
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
      direct<&Settings::width>("width", true),
      direct<&Settings::height>("height", true),
      direct<&Settings::interface_scale>("interface_scale", true),
      direct<&Settings::volume>("volume", true),
      direct<&Settings::mute>("mute", true),
      direct<&Settings::panels>("panels", true),
      direct<&Settings::overlay_contacts>("contacts", true),
      direct<&Settings::overlay_normals>("normals", true),
      direct<&Settings::overlay_pen>("pen_force", true),
      direct<&Settings::overlay_timing>("timing", true),
      direct<&Settings::overlay_scope>("scope", true),
      direct<&Settings::rumble>("rumble", true),
      direct<&Settings::least_rate>("least_rate", true),
      direct<&Settings::samples>("samples", true),
      direct<&Settings::paused>("paused", false),
      direct<&Settings::speed>("speed", false),
      direct<&Settings::pen>("pen", false),
      direct<&Settings::sees>("sees", false),
      direct<&Settings::moves>("moves", false),
      direct<&Settings::feels>("feels", false),
      direct<&Settings::hears>("hears", false),
      direct<&Settings::representation>("representation", false),
      direct<&Settings::mesh>("mesh", false),
      direct<&Settings::classic>("classic", false),
      direct<&Settings::depth>("depth", false),
      direct<&Settings::stiffness>("stiffness", false),
      direct<&Settings::papers_method>("papers_method", false),
  };
  return all;
}

bool set_by_name(Settings& settings, const std::string& name, double value) {
  for (const Setting& setting : settings_by_name()) {
    if (name != setting.name) continue;
    setting.set(settings, value);
    return true;
  }
  return false;
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
    setting.set(read, value);
  }
  reader.finish();
  if (error) return tl::unexpected(*error);
  read.width = std::clamp(read.width, 160, 7680);
  read.height = std::clamp(read.height, 120, 4320);
  read.samples = std::clamp(read.samples, 1, 4);
  settings = read;
  return {};
}

Result<void> write_settings(const fs::path& file, const Settings& settings) {
  if (file.empty()) return {};
  std::string text = "# Written by intaglio run when its window is closed.\n";
  for (const Setting& setting : settings_by_name())
    if (setting.is_kept) text += fmt::format("{} = {}\n", setting.name, setting.get(settings));
  return write_file(file, text);
}

}  // namespace intaglio::window
