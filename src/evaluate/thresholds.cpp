#include "evaluate/thresholds.h"

#include "intaglio_thresholds.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/file.h"
#include "core/toml.h"

namespace intaglio::evaluate {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::uintmax_t max_thresholds_bytes = 1u << 20;

const std::vector<std::string> pair_names{"touch-sound", "sight-touch", "sight-sound", "picture-motion"};
const std::vector<std::string> first_names{"either", "sight first", "touch first", "sound first"};

// The two senses of a pair that has times.
std::array<First, 2> senses_of(Pair pair) {
  switch (pair) {
    case Pair::touch_sound:
      return {First::touch, First::sound};
    case Pair::sight_touch:
      return {First::sight, First::touch};
    case Pair::sight_sound:
      return {First::sight, First::sound};
    case Pair::picture_motion:
      break;
  }
  return {First::either, First::either};
}

const Threshold* find(const std::vector<Threshold>& list, Pair pair, First first) {
  const auto found = std::find_if(list.begin(), list.end(), [&](const Threshold& threshold) {
    return threshold.pair == pair && threshold.first == first;
  });
  return found == list.end() ? nullptr : &*found;
}

// Reads one entry; `list` has those before it.
void read_threshold(TomlReader& reader, bool is_time, std::vector<Threshold>& list) {
  Threshold threshold;
  threshold.value = -1;
  for (const char* key : {"pair", "value", "spread", "condition", "source"})
    if (!reader.has(key))
      return reader.fail_at(key, fmt::format("{} is missing", key),
                            "a threshold has pair, value, spread, condition and source");
  reader.choice("pair", pair_names, threshold.pair);
  if (is_time) {
    if (!reader.has("direction"))
      return reader.fail_at("direction", "direction is missing",
                            "a time has a direction: \"either\" or \"<sense> first\"");
    reader.choice("direction", first_names, threshold.first);
  }
  const Range range = is_time ? Range{0, 10, true, "a time must be greater than 0 and at most 10 s"}
                              : Range{0, 10, true, "a place must be greater than 0 and at most 10 m"};
  reader.number("value", threshold.value, range);
  Vec2 spread(0, 0);
  reader.vec2("spread", spread, range);
  threshold.low = spread[0];
  threshold.high = spread[1];
  reader.string("condition", threshold.condition);
  reader.string("source", threshold.source);
  reader.finish();
  if (!(threshold.low <= threshold.value && threshold.value <= threshold.high))
    reader.fail_at("spread", fmt::format("the spread does not contain the value {}", threshold.value),
                   "spread is [low, high] with low <= value <= high");
  const auto senses = senses_of(threshold.pair);
  if (is_time && threshold.pair == Pair::picture_motion)
    reader.fail_at("pair", "picture and motion have one clock", "picture-motion has a place only");
  if (threshold.first != First::either && threshold.first != senses[0] && threshold.first != senses[1])
    reader.fail_at(
        "direction",
        fmt::format("{} has no direction \"{}\"", name_of(threshold.pair), name_of(threshold.first)),
        fmt::format("\"either\", \"{}\" or \"{}\"", name_of(senses[0]), name_of(senses[1])));
  for (const Threshold& other : list)
    if (other.pair == threshold.pair &&
        (other.first == threshold.first || other.first == First::either || threshold.first == First::either))
      reader.fail_at("pair", fmt::format("{} is given twice", name_of(threshold.pair)),
                     is_time ? "one time for either direction, or one for each" : "one place for a pair");
  list.push_back(std::move(threshold));
}

// Both directions, or neither.
Result<void> check_directions(const std::vector<Threshold>& times, const std::string& name) {
  for (const Threshold& time : times) {
    if (time.first == First::either) continue;
    const auto senses = senses_of(time.pair);
    const First other = time.first == senses[0] ? senses[1] : senses[0];
    if (!find(times, time.pair, other))
      return fail(name, fmt::format("{} has a time for \"{}\" only", name_of(time.pair), name_of(time.first)),
                  fmt::format("add one for \"{}\", or make it \"either\"", name_of(other)));
  }
  return {};
}

Result<Thresholds> parse_entries(std::string_view text, const std::string& name) {
  const auto table = parse_toml(text, name);
  if (!table) return tl::unexpected(table.error());
  Thresholds thresholds;
  std::optional<Error> error;
  TomlReader reader(*table, name, "", error);
  reader.tables("time", [&](TomlReader& entry) { read_threshold(entry, true, thresholds.times); });
  reader.tables("place", [&](TomlReader& entry) { read_threshold(entry, false, thresholds.places); });
  reader.finish();
  if (error) return tl::unexpected(*error);
  if (auto checked = check_directions(thresholds.times, name); !checked)
    return tl::unexpected(std::move(checked).error());
  return thresholds;
}

// Adds the built-in entries of pairs that `list` does not name.
void complete(std::vector<Threshold>& list, const std::vector<Threshold>& builtin) {
  const auto named = list;
  for (const Threshold& threshold : builtin)
    if (std::none_of(named.begin(), named.end(), [&](const auto& own) { return own.pair == threshold.pair; }))
      list.push_back(threshold);
}

}  // namespace

std::string_view name_of(Pair pair) {
  return pair_names[std::size_t(pair)];
}

std::string_view name_of(First first) {
  return first_names[std::size_t(first)];
}

double Thresholds::T(Pair pair, First first) const {
  if (const Threshold* both = find(times, pair, First::either)) return both->value;
  if (first != First::either) {
    const Threshold* one = find(times, pair, first);
    return one ? one->value : infinity;
  }
  double least = infinity;
  for (const Threshold& time : times)
    if (time.pair == pair) least = std::min(least, time.value);
  return least;
}

double Thresholds::S(Pair pair) const {
  const Threshold* place = find(places, pair, First::either);
  return place ? place->value : infinity;
}

const Thresholds& builtin_thresholds() {
  static const Thresholds builtin = parse_entries(embedded::thresholds, "thresholds.toml").value();
  return builtin;
}

Result<Thresholds> parse_thresholds(std::string_view text, const std::string& name) {
  auto thresholds = parse_entries(text, name);
  if (!thresholds) return thresholds;
  complete(thresholds->times, builtin_thresholds().times);
  complete(thresholds->places, builtin_thresholds().places);
  return thresholds;
}

Result<Thresholds> load_thresholds(const std::filesystem::path& path) {
  const auto text = read_text(path, max_thresholds_bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_thresholds(*text, path.string());
}

double jnd(double dt, double ds, double T, double S) {
  assert(T > 0 && S > 0);
  return std::sqrt(dt / T * (dt / T) + ds / S * (ds / S));
}

}  // namespace intaglio::evaluate
