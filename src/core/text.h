// Text in messages and files: the nearest name, an error within an error, JSON strings.
#pragma once

#include <string>
#include <string_view>

#include "intaglio/error.h"

namespace intaglio {

// Levenshtein distance of two words: inserted, deleted and changed letters.
int edit_distance(const std::string& a, const std::string& b);

// The candidate nearest to `word` in edit distance, for "did you mean". Empty when none is near.
template <class Range>
std::string nearest_name(const std::string& word, const Range& candidates) {
  std::string best;
  int best_distance = int(word.size()) / 2 + 2;
  for (const auto& candidate : candidates) {
    const int distance = edit_distance(word, std::string(candidate));
    if (distance < best_distance) {
      best_distance = distance;
      best = std::string(candidate);
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
