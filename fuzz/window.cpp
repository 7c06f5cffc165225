// Any text as an event script, and as the window's settings: each, or one clear error on one line. Accepted
// events ascend; accepted settings are within their ranges, rejected ones change nothing.
#include "fuzz/require.h"
#include "window/script.h"
#include "window/settings.h"

using namespace intaglio;
using namespace intaglio::window;
using fuzz::require;

namespace {

void examine(const std::vector<ScriptEvent>& events) {
  double last = 0;
  for (const ScriptEvent& event : events) {
    require(event.time >= last && event.where.starts_with("fuzz.script:"));
    last = event.time;
    Settings settings;
    if (event.verb == ScriptVerb::set) require(set_by_name(settings, event.text, event.x).has_value());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto text = fuzz::as_text(data, size);
  if (const auto events = parse_script(text, "fuzz.script"))
    examine(*events);
  else
    fuzz::require_clear(events.error(), "fuzz.script:");

  Settings settings;
  if (const auto read = parse_settings(text, "fuzz.toml", settings)) {
    for (const Setting& setting : all_settings())
      require(check_setting(setting.name, setting.get(settings)).has_value());
  } else {
    fuzz::require_clear(read.error(), "fuzz.toml");
    for (const Setting& setting : all_settings()) require(setting.get(settings) == setting.get(Settings()));
  }
  return 0;
}
