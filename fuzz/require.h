// Shared by fuzzers: conditions that must hold, bytes as text, and the form of an error.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "intaglio/error.h"

namespace intaglio::fuzz {

inline void require(bool holds) {
  if (!holds) std::abort();
}

inline std::string_view as_text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// An error is one line, and begins with the name of what was read.
inline void require_clear(const Error& error, std::string_view name) {
  const std::string message = error.message();
  require(message.find_first_of("\n\r") == std::string::npos && message.starts_with(name));
}

}  // namespace intaglio::fuzz
