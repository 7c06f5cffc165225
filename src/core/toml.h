// Strict reading of TOML tables: each key is read with type, range and default; unread keys are errors that
// name their line and the nearest known key. Only the first error is kept and later reads do nothing, so
// callers need no checks.
#pragma once

#include "intaglio/material.h"

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/vec.h"

#define TOML_HEADER_ONLY 1
#define TOML_EXCEPTIONS 0
// toml++ 3.3 declares characters from U+00A1 to U+0499 unreachable where white space is allowed. In a user's
// file they can occur there: make that "not white space" instead of undefined behaviour.
// (fuzz/seeds/scene/beyond_ascii.toml)
#include <toml++/impl/forward_declarations.h>
#undef TOML_UNREACHABLE
#define TOML_UNREACHABLE return false
#include <toml++/impl/unicode.h>
#undef TOML_UNREACHABLE
#define TOML_UNREACHABLE __builtin_unreachable()
#include <toml++/toml.h>

namespace intaglio {

// Parses TOML text; errors begin with `name` and the line.
// Fuzzed by fuzz/scene.cpp through parse_scene
Result<toml::table> parse_toml(std::string_view text, const std::string& name);

// Allowed range of a number.
struct Range {
  double low, high;
  bool low_open;     // low is excluded
  const char* says;  // "a mass must be greater than 0 kg"
};

class TomlReader {
 public:
  // `name` is the file, for errors; `error` receives the first one. `path` is the table's own name ("ball",
  // "pen.hand").
  TomlReader(const toml::table& table, std::string name, std::string path, std::optional<Error>& error)
      : table_(table), name_(std::move(name)), path_(std::move(path)), error_(error) {}

  void number(const char* key, double& value, const Range& range);
  // Leaves `value` unset when the key is absent.
  void number(const char* key, std::optional<double>& value, const Range& range) {
    if (has(key)) return number(key, value.emplace(), range);
    optional_key(key);
  }
  void integer(const char* key, int& value, const Range& range);
  void boolean(const char* key, bool& value);
  void string(const char* key, std::string& value);
  void vec3(const char* key, Vec3& value);
  void vec2(const char* key, Vec2& value, const Range& range);
  // One of `names`; `value` becomes its index.
  void choice(const char* key, const std::vector<std::string>& names, int& value);
  // The same for an enumeration whose values are in the order of `names`.
  template <class Enum>
  void choice(const char* key, const std::vector<std::string>& names, Enum& value) {
    int index = int(value);
    choice(key, names, index);
    value = Enum(index);
  }
  template <class Enum>
  void choice(const char* key, const std::vector<std::string>& names, std::optional<Enum>& value) {
    int index = -1;
    choice(key, names, index);
    if (index >= 0) value = Enum(index);
  }
  // Rows of `columns` numbers each.
  void rows(const char* key, std::size_t columns, std::vector<std::vector<double>>& value);
  // A sub-table; `read` is called if it is present.
  void table(const char* key, const std::function<void(TomlReader&)>& read);
  // An array of tables ([[key]]).
  void tables(const char* key, const std::function<void(TomlReader&)>& read);
  bool has(const char* key) const { return table_.contains(key); }
  // For a key that takes a table or something else.
  bool is_table(const char* key) const { return table_[key].is_table(); }
  // A list of strings, at most `most` of them.
  void strings(const char* key, std::size_t most, std::vector<std::string>& value);
  // The value of a key that its caller reads; null if it is absent or an error has occurred.
  const toml::node* node(const char* key) { return find(key); }
  // Allows a key that is read conditionally.
  void optional_key(const char* key) { known_.insert(key); }
  // "file:line" of the key, or of the table without it: for errors detected later.
  std::string line_of(const char* key) const;
  // `kind` uses, out of `all` keys, only `uses`; any other one present is an error.
  void only_keys(const std::string& kind, const std::vector<const char*>& uses,
                 const std::vector<const char*>& all);

  // Reports an error at the key's line (or the table's).
  void fail_at(const char* key, std::string what, std::string fix);
  // The same at the line of a value.
  void fail_at(const toml::node& node, std::string what, std::string fix) {
    set_error(node, std::move(what), std::move(fix));
  }
  bool has_failed() const { return error_.has_value(); }
  // Call last: reports the first unread key.
  void finish();

 private:
  const toml::node* find(const char* key);
  bool read_number(const char* key, const toml::node& node, const Range* range, double& value);
  std::string where(const toml::node& node) const;
  std::string full_key(const char* key) const { return path_.empty() ? std::string(key) : path_ + "." + key; }
  void set_error(const toml::node& node, std::string what, std::string fix);

  const toml::table& table_;
  std::string name_, path_;
  std::optional<Error>& error_;
  std::set<std::string> known_;
};

// Reads `key` into `material`, which holds the default: a built-in name, or a table that overrides parts of
// one.
//   material = "steel"
//   material = { name = "steel", rayleigh_alpha = 20, micro = { rms_height = 1e-6 } }
void read_material(TomlReader& reader, const char* key, Material& material);

// A material file: the keys of such a table at the top level. When `name` is not a built-in material it must
// give density, youngs_modulus, poisson_ratio, rayleigh_alpha and rayleigh_beta.
Result<Material> parse_material(std::string_view text, const std::string& file_name);

// Loads a material given on a command line: a built-in name, or a file whose name ends in .toml.
Result<Material> load_material(const std::string& name_or_file);

}  // namespace intaglio
