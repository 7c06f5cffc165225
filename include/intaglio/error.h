// Errors: values at the edges of the library (files, devices, networks, options).
//
// What can fail there returns Result<T>: a T, or an Error that reads as one line and says where, what is wrong
// and what would be right. Nothing throws but std::bad_alloc. Misuse in code (an index out of range, a null
// pointer) is an assert.
//
//   auto wall = intaglio::Surface::load("my_wall/");
//   if (!wall) { std::cerr << wall.error() << '\n'; return 1; }
//   use(*wall);                    // or wall.value(), which throws tl::bad_expected_access on an error
#pragma once

#include <iosfwd>
#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace intaglio {

struct Error {
  std::string where;  // a file, "file:line", "file: byte 1234", or a device
  std::string what;   // what is wrong
  std::string fix;    // what would be right; may be empty

  // One line, for people: "scenes/a.toml:12: mass is -1 kg; a mass must be greater than 0".
  std::string message() const;
};

std::ostream& operator<<(std::ostream& out, const Error& error);

template <class T>
using Result = tl::expected<T, Error>;

// The Result of a function that failed: `return fail(path, "no such file")`.
inline tl::unexpected<Error> fail(std::string where, std::string what, std::string fix = {}) {
  return tl::unexpected<Error>(Error{std::move(where), std::move(what), std::move(fix)});
}

}  // namespace intaglio
