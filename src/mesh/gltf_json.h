// Type-checked access to the untrusted JSON of a glTF file; each value knows its path for error messages
// ("accessors[3].count"). The first error wins and later reads are harmless, so readers need no check at
// every access, but must test `error` before they use results.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "intaglio/error.h"

namespace intaglio::surface {

class JsonValue {
 public:
  // Shared by all values of a file; it outlives them.
  struct File {
    std::string name;
    std::optional<Error> error;
  };

  JsonValue(const nlohmann::json* json, std::string path, File& file)
      : json_(json), path_(std::move(path)), file_(&file) {}

  // Whether the value exists. All accessors are safe on an absent value.
  explicit operator bool() const { return json_ != nullptr; }
  const std::string& path() const { return path_; }

  JsonValue operator[](const char* key) const;    // of an object; absent when it has no such key
  JsonValue operator[](std::size_t index) const;  // of an array; beyond its end an error
  std::size_t size() const;                       // of an array; 0 when absent

  // An integer in 0..limit; `fallback` when absent.
  std::size_t integer(std::size_t fallback, std::size_t limit) const;
  // The same, where absence is an error.
  std::size_t required_integer(std::size_t limit) const;
  double number(double fallback) const;
  bool boolean(bool fallback) const;
  std::string string() const;  // "" when absent

  void fail(std::string what, std::string fix = {}) const;

 private:
  const nlohmann::json* json_;
  std::string path_;
  File* file_;
};

// Text of a file, safe to print in an error: one line, not long.
std::string printable(std::string_view text);

// URIs in mesh files: base64 data and relative file names.

// The bytes of "data:...;base64,..."; absent when it is not one, or its text is not base64.
std::optional<std::vector<std::uint8_t>> data_uri(std::string_view uri);

// The file name of a relative uri with its %20s decoded; absent for anything that could escape the folder:
// schemes, absolute names, "..", backslashes, control characters.
std::optional<std::string> relative_file(std::string_view uri);

}  // namespace intaglio::surface
