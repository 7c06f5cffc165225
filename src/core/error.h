// Errors at the edges (files, network, command line) are values: Result<T> holds a T or an Error that reads
// as one line and says where, what is wrong, and what would be right. Programming errors are asserts.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
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

template <class T>
using Result = tl::expected<T, Error>;

inline tl::unexpected<Error> fail(std::string where, std::string what, std::string fix = {}) {
  return tl::unexpected<Error>(Error{std::move(where), std::move(what), std::move(fix)});
}

// The candidate that is most like `word` (least edit distance), for "did you mean". Empty when nothing is
// near.
template <class Range>
std::string nearest_name(const std::string& word, const Range& candidates);

// Levenshtein distance of two words: inserted, deleted and changed letters.
int edit_distance(const std::string& a, const std::string& b);

template <class Range>
std::string nearest_name(const std::string& word, const Range& candidates) {
  std::string best;
  int best_distance = static_cast<int>(word.size()) / 2 + 2;
  for (const auto& candidate : candidates) {
    const int distance = edit_distance(word, std::string(candidate));
    if (distance < best_distance) {
      best_distance = distance;
      best = std::string(candidate);
    }
  }
  return best;
}

// An error in what one file's line names (a texture, a device): the line comes first, so that both places are
// said. "a.toml:12: wall.png: no such file".

// `where` is the line; empty: the error as it is.
inline Error with_where(const std::string& where, const Error& error) {
  if (where.empty()) return error;
  return {where, error.where.empty() ? error.what : error.where + ": " + error.what, error.fix};
}

// Text as JSON writes it.

// In quotes; quotes, backslashes and control characters escaped. What is not UTF-8 is not looked at.
std::string json_quoted(std::string_view text);

}  // namespace intaglio
