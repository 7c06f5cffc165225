// Changes of a scene's keys, as a design's `set` tables say them: {"cues.pen_sound.on", "false"}.
//
// A list of dotted keys with their values as TOML, sorted by key, so that two that say the same are equal,
// and a trial's can be hashed, stored and printed as they are. Later changes win: put() removes what it
// replaces, also where a whole table and a part of it meet (cues.touch and cues.touch.delay). Values only,
// any thread.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "core/toml.h"
#include "intaglio/error.h"
#include "scene/scene.h"

namespace intaglio::study {

// Stands in a value for what is known only in a trial: the amount of an adaptive procedure, or the texture
// that is shown.
inline constexpr const char* placeholder = "@";

class Overrides {
 public:
  // The keys of a `set` table. Errors go to the reader, at the line of the value.
  void read(TomlReader& reader, const char* key);
  // `value` is TOML text.
  void put(const std::string& key, const std::string& value);
  void put_all(const Overrides& later);
  // A copy in which each value that is the placeholder, or a list with it, has `value` (TOML text) there.
  Overrides with(const std::string& value) const;
  bool has_placeholder() const;

  const std::map<std::string, std::string>& values() const { return values_; }
  bool empty() const { return values_.empty(); }
  bool operator==(const Overrides&) const = default;
  // One line a key: "cues.touch.on = false\n".
  std::string text() const;

 private:
  void add(TomlReader& reader, const std::string& path, const toml::node& node, int depth);

  std::map<std::string, std::string> values_;
};

// A text as a TOML string.
std::string toml_quoted(const std::string& text);
// A number as TOML, by the shortest text that gives it back.
std::string toml_number(double value);

// The scene that `base`, the text of a scene file (empty: the default scene), becomes by these changes.
// `name` is the file for errors; `folder`, where its textures may lie. Placeholders must be filled.
Result<scene::Scene> scene_with(const std::string& base, const Overrides& overrides, const std::string& name);

}  // namespace intaglio::study
