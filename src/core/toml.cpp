#include "core/toml.h"

#include <fmt/format.h>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <filesystem>

#include "core/file.h"
#include "core/text.h"

namespace intaglio {

namespace {

// The kind of a TOML value, for messages.
std::string kind(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::string:
      return "a string";
    case toml::node_type::boolean:
      return "true or false";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::table:
      return "a table";
    case toml::node_type::integer:
    case toml::node_type::floating_point:
      return "a number";
    default:
      return "a date or time";
  }
}

// The end of the string that begins at text[k], or of its line if it is not closed there.
std::size_t skip_string(std::string_view text, std::size_t k) {
  const char quote = text[k];
  const std::string triple(3, quote);
  const bool is_multiline = text.substr(k, 3) == triple;
  for (k += is_multiline ? 3 : 1; k < text.size(); ++k) {
    if (text[k] == '\\' && quote == '"') {
      ++k;
    } else if (!is_multiline && (text[k] == quote || text[k] == '\n')) {
      return k + 1;
    } else if (is_multiline && text.substr(k, 3) == triple) {
      k += 3;
      for (int extra = 0; extra < 2 && k < text.size() && text[k] == quote; ++extra) ++k;  // belong to it
      return k;
    }
  }
  return text.size();
}

// The line of the first dotted key or header of more than `most` parts; 0 if there is none. toml++ descends
// by recursion, one level for each part, and bounds only nested values (256): 300,000 parts exhaust the
// stack.
int line_of_long_key(std::string_view text, int most) {
  int dots = 0;
  for (std::size_t k = 0; k < text.size();) {
    const char c = text[k];
    if (c == '"' || c == '\'') {
      k = skip_string(text, k);
      continue;
    }
    if (c == '#') {
      k = std::min(text.find('\n', k), text.size());
      continue;
    }
    const bool is_in_key = std::isalnum(std::uint8_t(c)) != 0 || c == '_' || c == '-' || c == ' ' ||
                           c == '\t' || std::uint8_t(c) >= 0x80;
    if (c == '.') {
      if (++dots >= most) return 1 + int(std::count(text.begin(), text.begin() + std::ptrdiff_t(k), '\n'));
    } else if (!is_in_key) {
      dots = 0;
    }
    ++k;
  }
  return 0;
}

}  // namespace

Result<toml::table> parse_toml(std::string_view text, const std::string& name) {
  constexpr int most_parts = 32;
  if (const int line = line_of_long_key(text, most_parts); line > 0)
    return fail(fmt::format("{}:{}", name, line), fmt::format("a key of over {} parts", most_parts),
                "keys here have at most three: a.b.c");
  toml::parse_result parsed = toml::parse(text, name);
  if (parsed) return std::move(parsed).table();
  const toml::parse_error& error = parsed.error();
  return fail(fmt::format("{}:{}", name, error.source().begin.line), std::string(error.description()),
              "see the TOML reference, toml.io");
}

std::string TomlReader::where(const toml::node& node) const {
  return fmt::format("{}:{}", name_, node.source().begin.line);
}

void TomlReader::set_error(const toml::node& node, std::string what, std::string fix) {
  if (!error_) error_ = Error{where(node), std::move(what), std::move(fix)};
}

void TomlReader::fail_at(const char* key, std::string what, std::string fix) {
  const toml::node* node = table_.get(key);
  set_error(node != nullptr ? *node : table_, std::move(what), std::move(fix));
}

std::string TomlReader::line_of(const char* key) const {
  const toml::node* node = table_.get(key);
  return where(node != nullptr ? *node : table_);
}

void TomlReader::only_keys(const std::string& kind, const std::vector<const char*>& uses,
                           const std::vector<const char*>& all) {
  for (const char* key : all) {
    const bool is_used = std::any_of(uses.begin(), uses.end(),
                                     [&](const char* used) { return std::string_view(used) == key; });
    if (is_used || !has(key)) continue;
    return fail_at(
        key, fmt::format("{} does not use {}", kind, full_key(key)),
        uses.empty() ? "leave it out" : fmt::format("leave it out; it uses: {}", fmt::join(uses, ", ")));
  }
}

const toml::node* TomlReader::find(const char* key) {
  known_.insert(key);
  return error_ ? nullptr : table_.get(key);
}

bool TomlReader::read_number(const char* key, const toml::node& node, const Range* range, double& value) {
  const auto number = node.value<double>();
  if (!number || node.is_boolean() || node.is_string()) {
    set_error(node, fmt::format("{} is {}", full_key(key), kind(node)), "a number is required");
    return false;
  }
  if (!std::isfinite(*number)) {
    set_error(node, fmt::format("{} is {}", full_key(key), *number), "a finite number is required");
    return false;
  }
  if (range != nullptr &&
      (*number < range->low || *number > range->high || (range->low_open && *number == range->low))) {
    set_error(node, fmt::format("{} is {}", full_key(key), *number), range->says);
    return false;
  }
  value = *number;
  return true;
}

void TomlReader::number(const char* key, double& value, const Range& range) {
  if (const toml::node* node = find(key)) read_number(key, *node, &range, value);
}

void TomlReader::integer(const char* key, int& value, const Range& range) {
  const toml::node* node = find(key);
  double number = value;
  if (node == nullptr || !read_number(key, *node, &range, number)) return;
  if (number != std::floor(number))
    return set_error(*node, fmt::format("{} is {}", full_key(key), number), "an integer is required");
  value = int(number);
}

void TomlReader::boolean(const char* key, bool& value) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  if (!node->is_boolean())
    return set_error(*node, fmt::format("{} is {}", full_key(key), kind(*node)), "true or false is required");
  value = node->value_or(value);
}

void TomlReader::string(const char* key, std::string& value) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  if (!node->is_string())
    return set_error(*node, fmt::format("{} is {}", full_key(key), kind(*node)),
                     "a quoted string is required");
  value = node->value_or(std::string());
}

void TomlReader::vec3(const char* key, Vec3& value) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  if (array == nullptr || array->size() != 3) {
    return set_error(*node,
                     fmt::format("{} is {}{}", full_key(key), kind(*node),
                                 array != nullptr ? fmt::format(" of {}", array->size()) : ""),
                     "three numbers are required: [x, y, z]");
  }
  // Beyond any useful scene; Bullet squares these in floats.
  static constexpr Range sane{-1e4, 1e4, false, "each number must be between -10000 and 10000"};
  for (std::size_t k = 0; k < 3; ++k) {
    if (!read_number(key, (*array)[k], &sane, value[Eigen::Index(k)])) return;
  }
}

void TomlReader::vec2(const char* key, Vec2& value, const Range& range) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  if (array == nullptr || array->size() != 2)
    return set_error(*node, fmt::format("{} is not two numbers", full_key(key)),
                     "two numbers are required: [u, v]");
  for (std::size_t k = 0; k < 2; ++k) {
    if (!read_number(key, (*array)[k], &range, value[Eigen::Index(k)])) return;
  }
}

void TomlReader::choice(const char* key, const std::vector<std::string>& names, int& value) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  const std::string name = node->value_or(std::string());
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (names[k] == name && node->is_string()) {
      value = int(k);
      return;
    }
  }
  set_error(*node,
            fmt::format("{} is {}", full_key(key), node->is_string() ? "\"" + name + "\"" : kind(*node)),
            fmt::format("it must be one of \"{}\"", fmt::join(names, "\", \"")));
}

void TomlReader::rows(const char* key, std::size_t columns, std::vector<std::vector<double>>& value) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  const std::string fix = fmt::format("an array of rows of {} numbers is required", columns);
  if (!node->is_array()) return set_error(*node, fmt::format("{} is {}", full_key(key), kind(*node)), fix);
  value.clear();
  for (const toml::node& row : *node->as_array()) {
    const toml::array* numbers = row.as_array();
    if (numbers == nullptr || numbers->size() != columns)
      return set_error(
          row, fmt::format("row {} of {} is not {} numbers", value.size() + 1, full_key(key), columns), fix);
    value.emplace_back(columns);
    for (std::size_t k = 0; k < columns; ++k) {
      if (!read_number(key, (*numbers)[k], nullptr, value.back()[k])) return;
    }
  }
}

void TomlReader::strings(const char* key, std::size_t most, std::vector<std::string>& value) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  if (array == nullptr)
    return set_error(*node, fmt::format("{} is {}", full_key(key), kind(*node)),
                     "a list of quoted strings is required: [\"a\", \"b\"]");
  if (array->size() > most)
    return set_error(*node, fmt::format("{} has {} entries", full_key(key), array->size()),
                     fmt::format("at most {}", most));
  value.clear();
  for (const toml::node& item : *array) {
    if (!item.is_string())
      return set_error(item, fmt::format("an entry of {} is {}", full_key(key), kind(item)),
                       "a quoted string is required");
    value.push_back(item.value_or(std::string()));
  }
}

void TomlReader::table(const char* key, const std::function<void(TomlReader&)>& read) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  if (!node->is_table())
    return set_error(*node, fmt::format("{} is {}", full_key(key), kind(*node)),
                     fmt::format("a table is required: [{}]", full_key(key)));
  TomlReader reader(*node->as_table(), name_, full_key(key), error_);
  read(reader);
  reader.finish();
}

void TomlReader::tables(const char* key, const std::function<void(TomlReader&)>& read) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  if (array == nullptr || !array->is_homogeneous(toml::node_type::table))
    return set_error(*node, fmt::format("{} is {}", full_key(key), kind(*node)),
                     fmt::format("tables are required: [[{}]]", full_key(key)));
  for (const toml::node& item : *array) {
    TomlReader reader(*item.as_table(), name_, full_key(key), error_);
    read(reader);
    reader.finish();
  }
}

void TomlReader::finish() {
  if (error_) return;
  for (const auto& [key, node] : table_) {
    const std::string name(key.str());
    if (known_.contains(name)) continue;
    const std::string nearest = nearest_name(name, known_);
    error_ = Error{fmt::format("{}:{}", name_, key.source().begin.line),
                   fmt::format("unknown key \"{}\"", full_key(name.c_str())),
                   nearest.empty() ? fmt::format("known keys: {}", fmt::join(known_, ", "))
                                   : fmt::format("did you mean \"{}\"?", nearest)};
    return;
  }
}

// --- Materials ---

namespace {

void read_micro(TomlReader& r, MicroRoughness& micro) {
  r.number("rms_height", micro.rms_height, {0, 1e-2, false, "a height must be between 0 m and 0.01 m"});
  r.number("correlation_length", micro.correlation_length,
           {0, 1, true, "it must be greater than 0 m, at most 1 m"});
  r.number("spectral_slope", micro.spectral_slope,
           {-6, 0, false, "a spectral slope must be between -6 and 0"});
}

void read_overrides(TomlReader& r, Material& m) {
  r.number("density", m.density,
           {1, 1e5, false, "a density must be between 1 and 100000 kg/m^3 (aerogel to beyond osmium)"});
  r.number("youngs_modulus", m.youngs_modulus,
           {1e3, 1e13, false, "a Young's modulus must be between 1e3 and 1e13 Pa (jelly to beyond diamond)"});
  r.number("poisson_ratio", m.poisson_ratio,
           {-0.9, 0.49, false, "a Poisson ratio must be between -0.9 and 0.49"});
  r.number("rayleigh_alpha", m.rayleigh_alpha, {0, 1e6, false, "alpha must be between 0 and 1e6 1/s"});
  r.number("rayleigh_beta", m.rayleigh_beta, {0, 1, false, "beta must be between 0 and 1 s"});
  r.number("friction", m.friction, {0, 10, false, "friction must be between 0 and 10"});
  r.number("restitution", m.restitution, {0, 1, false, "restitution must be between 0 and 1"});
  r.number("rolling_resistance", m.rolling_resistance,
           {0, 1, false, "rolling resistance must be between 0 and 1"});
  r.table("micro", [&](TomlReader& t) { read_micro(t, m.micro); });
  // Outside this range FEM elements become too small, or no mode is audible.
  const double speed = std::sqrt(m.youngs_modulus / m.density);
  if (speed < 10 || speed > 50'000)
    r.fail_at(r.has("youngs_modulus") ? "youngs_modulus" : "density",
              fmt::format("the speed of sound would be {:.3g} m/s", speed),
              "the square root of youngs_modulus over density must be between 10 and 50000 m/s (rubber 30, "
              "steel 5000, diamond 18000)");
  if (m.rayleigh_alpha == 0 && m.rayleigh_beta == 0)
    r.fail_at(r.has("rayleigh_alpha") ? "rayleigh_alpha" : "rayleigh_beta", "the material has no damping",
              "rayleigh_alpha or rayleigh_beta must be greater than 0");
}

}  // namespace

void read_material(TomlReader& reader, const char* key, Material& material) {
  const auto start_from = [&](TomlReader& at, const char* name_key) {
    std::string name = material.name;
    at.string(name_key, name);
    if (name == material.name) return;
    const auto found = find_material(name);
    if (found) {
      material = *found;
    } else {
      at.fail_at(name_key, found.error().what, found.error().fix);
    }
  };
  if (!reader.is_table(key)) return start_from(reader, key);
  reader.table(key, [&](TomlReader& t) {
    start_from(t, "name");
    read_overrides(t, material);
  });
}

Result<Material> parse_material(std::string_view text, const std::string& file_name) {
  const auto table = parse_toml(text, file_name);
  if (!table) return tl::unexpected(table.error());
  std::optional<Error> error;
  TomlReader reader(*table, file_name, "", error);
  Material material;
  material.name = std::filesystem::path(file_name).stem().string();
  reader.string("name", material.name);
  if (auto known = find_material(material.name); known && reader.has("name")) {
    material = *known;
  } else {
    for (const char* key :
         {"density", "youngs_modulus", "poisson_ratio", "rayleigh_alpha", "rayleigh_beta"}) {
      if (!error && !reader.has(key))
        return fail(
            file_name, fmt::format("{} is missing", key),
            "a material needs density, youngs_modulus, poisson_ratio, rayleigh_alpha and rayleigh_beta "
            "in SI units, or the name of a built-in one");
    }
  }
  read_overrides(reader, material);
  reader.finish();
  if (error) return tl::unexpected(*error);
  return material;
}

Result<Material> load_material(const std::string& name_or_file) {
  if (!name_or_file.ends_with(".toml")) return find_material(name_or_file);
  const auto text = read_text(name_or_file, 1u << 20);
  if (!text) return tl::unexpected(text.error());
  return parse_material(*text, name_or_file);
}

}  // namespace intaglio
