// Thresholds of agreement: how far apart in time and place two senses may present one event before it is
// noticed, each with its source.
//
// The built-in ones are src/evaluate/thresholds.toml, which is part of the library and explains each. A file
// of a user's own has the same form; each pair and kind (time or place) that it names replaces the built-in
// entries of that pair and kind. A pair without a threshold has an infinite one: that part of a difference is
// not counted. Units: seconds and metres. Pure functions, any thread; parsing allocates.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "intaglio/error.h"

namespace intaglio::evaluate {

// Picture and motion are one event on one clock, drawn and simulated: their places can differ, but not their
// times.
enum class Pair { touch_sound, sight_touch, sight_sound, picture_motion };
inline constexpr int pair_count = 4;

// Which sense of a pair presents the event first.
enum class First { either, sight, touch, sound };

std::string_view name_of(Pair pair);    // as in files: "touch-sound"
std::string_view name_of(First first);  // "sight first"

struct Threshold {
  Pair pair = Pair::touch_sound;
  First first = First::either;  // of a place: either
  double value = 0;             // s or m, greater than 0
  double low = 0, high = 0;     // spread over studies, with value between them
  std::string condition, source;
};

struct Thresholds {
  std::vector<Threshold> times;   // a pair has one entry, for either direction, or one for each
  std::vector<Threshold> places;  // at most one a pair

  // In seconds, when `first` comes first; when either may, the smaller one. Infinite without one.
  double T(Pair pair, First first = First::either) const;
  // In metres; infinite without one.
  double S(Pair pair) const;
};

const Thresholds& builtin_thresholds();

// `name` begins every error. Errors: a key, type or range that the format does not have, a pair that is named
// twice, a direction that the pair does not have, one direction without the other.
Result<Thresholds> parse_thresholds(std::string_view text, const std::string& name);
Result<Thresholds> load_thresholds(const std::filesystem::path& path);

// Just noticeable differences between two presentations of an event: sqrt((dt/T)^2 + (ds/S)^2), 1 at a
// threshold. `dt` (s) and `ds` (m) of either sign; T and S greater than 0, and infinite to leave a part out.
double jnd(double dt, double ds, double T, double S);

// Stands for an event that one sense does not present at all.
inline constexpr double missed_jnd = 3;

}  // namespace intaglio::evaluate
