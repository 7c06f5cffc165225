#include "intaglio/core/toml_reader.h"

#include <algorithm>
#include <cmath>

namespace intaglio {

namespace {

// What a TOML value is, for people.
std::string kind(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::string:
      return "a text";
    case toml::node_type::boolean:
      return "true or false";
    case toml::node_type::array:
      return "a list";
    case toml::node_type::table:
      return "a table";
    case toml::node_type::integer:
    case toml::node_type::floating_point:
      return "a number";
    default:
      return "a date or time";
  }
}

}  // namespace

Result<toml::table> parse_toml(std::string_view text, const std::string& name) {
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
    return fail_at(key, fmt::format("{} says nothing of {}", full(key), kind),
                   uses.empty() ? "leave it out"
                                : fmt::format("leave it out; what is read here: {}", fmt::join(uses, ", ")));
  }
}

const toml::node* TomlReader::take(const char* key) {
  known_.insert(key);
  return error_ ? nullptr : table_.get(key);
}

bool TomlReader::read_number(const char* key, const toml::node& node, const Range* range, double& value) {
  const auto number = node.value<double>();
  if (!number || node.is_boolean() || node.is_string()) {
    set_error(node, fmt::format("{} is {}", full(key), kind(node)), "a number is needed");
    return false;
  }
  if (!std::isfinite(*number)) {
    set_error(node, fmt::format("{} is {}", full(key), *number), "a finite number is needed");
    return false;
  }
  if (range != nullptr &&
      (*number < range->low || *number > range->high || (range->low_open && *number == range->low))) {
    set_error(node, fmt::format("{} is {}", full(key), *number), range->says);
    return false;
  }
  value = *number;
  return true;
}

void TomlReader::number(const char* key, double& value, const Range& range) {
  if (const toml::node* node = take(key)) read_number(key, *node, &range, value);
}

void TomlReader::whole(const char* key, int& value, const Range& range) {
  const toml::node* node = take(key);
  double number = value;
  if (node == nullptr || !read_number(key, *node, &range, number)) return;
  if (number != std::floor(number))
    return set_error(*node, fmt::format("{} is {}", full(key), number), "a whole number is needed");
  value = static_cast<int>(number);
}

void TomlReader::text(const char* key, std::string& value) {
  const toml::node* node = take(key);
  if (node == nullptr) return;
  if (!node->is_string())
    return set_error(*node, fmt::format("{} is {}", full(key), kind(*node)), "a text in quotes is needed");
  value = node->value_or(std::string());
}

void TomlReader::vector(const char* key, Vec3& value) {
  const toml::node* node = take(key);
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  if (array == nullptr || array->size() != 3) {
    return set_error(*node,
                     fmt::format("{} is {}{}", full(key), kind(*node),
                                 array != nullptr ? fmt::format(" of {}", array->size()) : ""),
                     "three numbers are needed: [x, y, z]");
  }
  // Farther or faster than anything that touches; what follows squares these numbers in floats.
  static constexpr Range sane{-1e4, 1e4, false, "each number must be between -10000 and 10000"};
  for (std::size_t k = 0; k < 3; ++k) {
    if (!read_number(key, (*array)[k], &sane, value[static_cast<Eigen::Index>(k)])) return;
  }
}

void TomlReader::pair(const char* key, Vec2& value, const Range& range) {
  const toml::node* node = take(key);
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  if (array == nullptr || array->size() != 2)
    return set_error(*node, fmt::format("{} is not two numbers", full(key)),
                     "two numbers are needed: [u, v]");
  for (std::size_t k = 0; k < 2; ++k) {
    if (!read_number(key, (*array)[k], &range, value[static_cast<Eigen::Index>(k)])) return;
  }
}

void TomlReader::choice(const char* key, const std::vector<std::string>& names, int& value) {
  const toml::node* node = take(key);
  if (node == nullptr) return;
  const std::string name = node->value_or(std::string());
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (names[k] == name && node->is_string()) {
      value = static_cast<int>(k);
      return;
    }
  }
  set_error(*node, fmt::format("{} is {}", full(key), node->is_string() ? "\"" + name + "\"" : kind(*node)),
            fmt::format("it must be one of \"{}\"", fmt::join(names, "\", \"")));
}

void TomlReader::rows(const char* key, std::size_t columns, std::vector<std::vector<double>>& value) {
  const toml::node* node = take(key);
  if (node == nullptr) return;
  const std::string fix = fmt::format("a list of rows of {} numbers is needed", columns);
  if (!node->is_array()) return set_error(*node, fmt::format("{} is {}", full(key), kind(*node)), fix);
  value.clear();
  for (const toml::node& row : *node->as_array()) {
    const toml::array* numbers = row.as_array();
    if (numbers == nullptr || numbers->size() != columns)
      return set_error(
          row, fmt::format("row {} of {} is not {} numbers", value.size() + 1, full(key), columns), fix);
    value.emplace_back(columns);
    for (std::size_t k = 0; k < columns; ++k) {
      if (!read_number(key, (*numbers)[k], nullptr, value.back()[k])) return;
    }
  }
}

void TomlReader::table(const char* key, const std::function<void(TomlReader&)>& read) {
  const toml::node* node = take(key);
  if (node == nullptr) return;
  if (!node->is_table())
    return set_error(*node, fmt::format("{} is {}", full(key), kind(*node)),
                     fmt::format("a table is needed: [{}]", full(key)));
  TomlReader reader(*node->as_table(), name_, full(key), error_);
  read(reader);
  reader.finish();
}

void TomlReader::tables(const char* key, const std::function<void(TomlReader&)>& read) {
  const toml::node* node = take(key);
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  if (array == nullptr || !array->is_homogeneous(toml::node_type::table))
    return set_error(*node, fmt::format("{} is {}", full(key), kind(*node)),
                     fmt::format("tables are needed: [[{}]]", full(key)));
  for (const toml::node& item : *array) {
    TomlReader reader(*item.as_table(), name_, full(key), error_);
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
                   fmt::format("unknown key \"{}\"", full(name.c_str())),
                   nearest.empty() ? fmt::format("known here: {}", fmt::join(known_, ", "))
                                   : fmt::format("did you mean \"{}\"?", nearest)};
    return;
  }
}

}  // namespace intaglio
