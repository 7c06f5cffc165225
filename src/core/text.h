// Text in messages and files: case, printable text, the nearest name, an error within an error, JSON strings.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "intaglio/error.h"

namespace intaglio {

// ASCII letters in lower case.
std::string lower_case(std::string text);

// Text from files and libraries, for messages: bytes that are not printable ASCII become '?'.
std::string printable(std::string text);

// Writes to standard error. Does nothing if that is closed, full or broken, because no other place for
// messages is left; fmt::print would throw.
void print_error(std::string_view text);

// Levenshtein distance of two words: inserted, deleted and changed letters.
int edit_distance(const std::string& a, const std::string& b);

// The candidate nearest to `word` in edit distance, for "did you mean". Empty when none is near: more than
// half of the word's letters would have to change, or no letter stays.
template <class Range>
std::string nearest_name(const std::string& word, const Range& candidates) {
  std::string best;
  int best_distance = std::max(1, int(word.size()) / 2) + 1;
  for (const auto& candidate : candidates) {
    const std::string name(candidate);
    const int distance = edit_distance(word, name);
    if (distance < best_distance && distance < int(std::max(word.size(), name.size()))) {
      best_distance = distance;
      best = name;
    }
  }
  return best;
}

// An error in something that a line of a file names (a texture, a device): both places, the line first, as in
// "a.toml:12: wall.png: no such file". With an empty `where`, the error as it is.
inline Error with_where(const std::string& where, const Error& error) {
  if (where.empty()) return error;
  return {where, error.where.empty() ? error.what : error.where + ": " + error.what, error.fix};
}

// `text` as a JSON string, in quotes; quotes, backslashes and control characters are escaped, other bytes are
// copied.
std::string json_quoted(std::string_view text);

}  // namespace intaglio
