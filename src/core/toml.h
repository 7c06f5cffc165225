// Strict reading of TOML tables: each key is asked for with its type, range and default; whatever was not
// asked for is an error that names its line and the nearest known key. The first error wins and later reads
// are harmless, so that a scene reads as a plain list of its keys.
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
// toml++ 3.3 tells its compiler that a bare character from U+00A1 to U+0499 cannot occur where white space
// may stand. In a file from a user it can; make that "no, it is not white space" instead of undefined
// behaviour. (fuzz/seeds/scene/beyond_ascii.toml)
#include <toml++/impl/forward_declarations.h>
#undef TOML_UNREACHABLE
#define TOML_UNREACHABLE return false
#include <toml++/impl/unicode.h>
#undef TOML_UNREACHABLE
#define TOML_UNREACHABLE __builtin_unreachable()
#include <toml++/toml.h>

namespace intaglio {

// Parses TOML text; `name` stands for the file in errors, which carry the line.
Result<toml::table> parse_toml(std::string_view text, const std::string& name);

// What a number must be.
struct Range {
  double low, high;
  bool low_open;     // low itself is not allowed
  const char* says;  // "a mass must be greater than 0 kg"
};

class TomlReader {
 public:
  // `name` is the file, for errors; `error` collects the first one. `path` is the table's own name ("ball",
  // "pen.hand").
  TomlReader(const toml::table& table, std::string name, std::string path, std::optional<Error>& error)
      : table_(table), name_(std::move(name)), path_(std::move(path)), error_(error) {}

  void number(const char* key, double& value, const Range& range);
  // Leaves `value` unset when the key is absent.
  void number(const char* key, std::optional<double>& value, const Range& range) {
    if (has(key)) return number(key, value.emplace(), range);
    optional_key(key);
  }
  void whole(const char* key, int& value, const Range& range);
  void text(const char* key, std::string& value);
  void vector(const char* key, Vec3& value);
  void pair(const char* key, Vec2& value, const Range& range);
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
  // A sub-table; absent: `read` is not called.
  void table(const char* key, const std::function<void(TomlReader&)>& read);
  // An array of tables ([[key]]).
  void tables(const char* key, const std::function<void(TomlReader&)>& read);
  bool has(const char* key) const { return table_.contains(key); }
  bool is_table(const char* key) const { return table_[key].is_table(); }
  // Makes a key known that is read only when it is there.
  void optional_key(const char* key) { known_.insert(key); }
  // "file:line" of the key, or of the table without it: for what turns out to be wrong only later.
  std::string line_of(const char* key) const;
  // Something of this kind has, of all these keys, only those that it uses: another one is an error.
  void only_keys(const std::string& kind, const std::vector<const char*>& uses,
                 const std::vector<const char*>& all);

  // Reports an error at the key's line (or the table's).
  void fail_at(const char* key, std::string what, std::string fix);
  // To be called last: any key that was not asked for is an error.
  void finish();

 private:
  const toml::node* take(const char* key);
  bool read_number(const char* key, const toml::node& node, const Range* range, double& value);
  std::string where(const toml::node& node) const;
  std::string full(const char* key) const { return path_.empty() ? std::string(key) : path_ + "." + key; }
  void set_error(const toml::node& node, std::string what, std::string fix);

  const toml::table& table_;
  std::string name_, path_;
  std::optional<Error>& error_;
  std::set<std::string> known_;
};

// A material in a TOML file: a built-in name, or a table that overrides parts of one.
//   material = "steel"     or     material = { name = "steel", rayleigh_alpha = 20, micro = { rms_height =
//   1e-6 } }

// Reads `key` into `material`, which holds the default.
void read_material(TomlReader& reader, const char* key, Material& material);

// A material as a TOML text of its own: the keys of such a table at the top level. When `name` is not a
// built-in material it must give density, youngs_modulus, poisson_ratio, rayleigh_alpha and rayleigh_beta.
Result<Material> parse_material(std::string_view text, const std::string& file_name);

// What a command line calls a material: a built-in name, or a file whose name ends in .toml.
Result<Material> named_material(const std::string& name_or_file);

}  // namespace intaglio
