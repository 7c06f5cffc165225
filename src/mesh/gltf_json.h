// The JSON of a glTF file, read without trust: every value is asked for with its type, and each knows its
// path for errors ("accessors[3].count"). The first error wins and later reads are harmless, so that the
// reader of the mesh stays a plain list of what it wants; it must look at `error` before it believes what it
// got.
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
  JsonValue(const nlohmann::json* json, std::string path, std::string file, std::optional<Error>& error)
      : json_(json), path_(std::move(path)), file_(std::move(file)), error_(&error) {}

  // Whether the file has it at all. Everything below is harmless when it has not.
  explicit operator bool() const { return json_ != nullptr; }
  const std::string& path() const { return path_; }

  JsonValue operator[](const char* key) const;    // of an object; absent when it has no such key
  JsonValue operator[](std::size_t index) const;  // of an array; beyond its end an error
  std::size_t size() const;                       // of an array; 0 when absent
  std::vector<std::string> keys() const;          // of an object

  // A whole number in 0..limit; `otherwise` when absent.
  std::size_t whole(std::size_t otherwise, std::size_t limit) const;
  // The same, where absence is an error.
  std::size_t required_whole(std::size_t limit) const;
  double number(double otherwise) const;
  bool truth(bool otherwise) const;
  std::string text() const;  // "" when absent

  void fail(std::string what, std::string fix = {}) const;

 private:
  const nlohmann::json* json_;
  std::string path_, file_;
  std::optional<Error>* error_;
};

// Text of a file, safe to print in an error: one line, not long.
std::string printable(std::string_view text);

// The two uris that a mesh file may use for its bytes: data in base64, and the relative name of a side file.

// The bytes of "data:...;base64,..."; absent when it is not one, or its text is not base64.
std::optional<std::vector<std::uint8_t>> data_uri(std::string_view uri);

// The file name of a relative uri with its %20s decoded; absent for anything that could lead elsewhere:
// schemes, absolute names, "..", backslashes, control characters.
std::optional<std::string> side_file(std::string_view uri);

}  // namespace intaglio::surface
