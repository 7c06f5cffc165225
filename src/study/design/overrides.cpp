#include "study/design/overrides.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/text.h"
#include "scene/scene_table.h"

namespace intaglio::study {

namespace {

constexpr int most_depth = 8;
constexpr std::size_t most_keys = 64, most_value = 4000;

bool is_bare(std::string_view key) {
  return !key.empty() && key.size() <= 40 && std::all_of(key.begin(), key.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

// The node as TOML on one line; nothing for what scenes have not: dates, deep or long values.
std::optional<std::string> value_text(const toml::node& node, int depth) {
  if (depth > most_depth) return std::nullopt;
  if (const auto flag = node.as_boolean()) return flag->get() ? "true" : "false";
  if (const auto number = node.as_integer()) return fmt::format("{}", number->get());
  if (const auto number = node.as_floating_point()) return toml_number(number->get());
  if (const auto text = node.as_string()) return toml_quoted(text->get());
  std::string all;
  const auto add = [&](const std::string& name, const toml::node& item) {
    const auto text = all.size() > most_value ? std::nullopt : value_text(item, depth + 1);
    if (!text) return false;
    all += (all.empty() ? "" : ", ") + name + *text;
    return true;
  };
  if (const toml::array* array = node.as_array()) {
    for (const toml::node& item : *array)
      if (!add("", item)) return std::nullopt;
    return "[" + all + "]";
  }
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, item] : *table)
      if (!is_bare(key.str()) || !add(std::string(key.str()) + " = ", item)) return std::nullopt;
    return "{" + all + "}";
  }
  return std::nullopt;
}

const std::string quoted_placeholder = toml_quoted(placeholder);

}  // namespace

std::string toml_quoted(const std::string& text) {
  return json_quoted(text);
}

std::string toml_number(double value) {
  if (!std::isfinite(value)) return "nan";
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

void Overrides::read(TomlReader& reader, const char* key) {
  const toml::node* node = reader.node(key);
  if (node == nullptr) return;
  const toml::table* table = node->as_table();
  if (table == nullptr)
    return reader.fail_at(*node, std::string(key) + " is not a table of scene keys",
                          fmt::format("for example {}.cues.touch = false (docs/scene.md)", key));
  for (const auto& [name, value] : *table) {
    if (!is_bare(name.str()))
      return reader.fail_at(value, fmt::format("{} has a key that is no scene key", key),
                            "see docs/scene.md");
    add(reader, std::string(name.str()), value, 1);
  }
}

void Overrides::add(TomlReader& reader, const std::string& path, const toml::node& node, int depth) {
  if (reader.has_failed()) return;
  const toml::table* table = node.as_table();
  if (table != nullptr && depth < 4) {
    for (const auto& [name, value] : *table) {
      if (!is_bare(name.str()))
        return reader.fail_at(value, path + " has a key that is no scene key", "see docs/scene.md");
      add(reader, path + "." + std::string(name.str()), value, depth + 1);
    }
    return;
  }
  const auto text = value_text(node, 0);
  if (!text || text->size() > most_value)
    return reader.fail_at(node, "the value of " + path + " is no value of a scene",
                          "a number, a text, true, false, or a short list of them");
  if (values_.size() >= most_keys)
    return reader.fail_at(node, fmt::format("over {} scene keys are set", most_keys),
                          "put what all trials share into the scene's file");
  put(path, *text);
}

void Overrides::put(const std::string& key, const std::string& value) {
  std::erase_if(values_, [&](const auto& old) {
    return old.first.starts_with(key + ".") || key.starts_with(old.first + ".");
  });
  values_[key] = value;
}

void Overrides::put_all(const Overrides& later) {
  for (const auto& [key, value] : later.values_) put(key, value);
}

bool Overrides::has_placeholder() const {
  return std::any_of(values_.begin(), values_.end(), [](const auto& entry) {
    return entry.second.find(quoted_placeholder) != std::string::npos;
  });
}

Overrides Overrides::with(const std::string& value) const {
  Overrides filled = *this;
  for (auto& [key, text] : filled.values_) {
    for (auto at = text.find(quoted_placeholder); at != std::string::npos;
         at = text.find(quoted_placeholder, at + value.size()))
      text.replace(at, quoted_placeholder.size(), value);
  }
  return filled;
}

std::string Overrides::text() const {
  std::string lines;
  for (const auto& [key, value] : values_) lines += key + " = " + value + "\n";
  return lines;
}

namespace {

// The table at a dotted path without its last part, made where there is none.
toml::table* table_at(toml::table& root, std::string_view& path) {
  toml::table* at = &root;
  for (auto dot = path.find('.'); dot != std::string_view::npos; dot = path.find('.')) {
    const std::string part(path.substr(0, dot));
    path.remove_prefix(dot + 1);
    toml::node* next = at->get(part);
    // cues.touch = false in the scene, and a part of it here: the table takes its place.
    if (next == nullptr || next->is_boolean() || next->is_string()) {
      at->insert_or_assign(part, toml::table{});
      next = at->get(part);
    }
    at = next->as_table();
    if (at == nullptr) return nullptr;
  }
  return at;
}

}  // namespace

Result<scene::Scene> scene_with(const std::string& base, const Overrides& overrides,
                                const std::string& name) {
  auto root = parse_toml(base, name);
  if (!root) return tl::unexpected(root.error());
  const auto changes = parse_toml(overrides.text(), name);
  if (!changes) return tl::unexpected(changes.error());
  for (const auto& [key, unused] : overrides.values()) {
    std::string_view path = key;
    toml::table* const at = table_at(*root, path);
    if (at == nullptr)
      return fail(name, key + " cannot be set", "a list of tables is replaced as a whole: ball = [{ ... }]");
    const auto value = changes->at_path(key);
    value.visit([&](const auto& node) { at->insert_or_assign(path, node); });
  }
  return scene::scene_of_table(*root, name);
}

}  // namespace intaglio::study
