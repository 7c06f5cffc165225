// Thresholds come from their file with their sources; a user's file replaces what it names, or says why not.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "core/file.h"
#include "evaluate/thresholds.h"
#include "tests/temporary_folder.h"

using namespace intaglio;
using namespace intaglio::evaluate;

namespace {

constexpr double no_threshold = std::numeric_limits<double>::infinity();

std::string entry(const std::string& kind, const std::string& pair, const std::string& direction,
                  const std::string& value = "0.03", const std::string& spread = "[0.02, 0.04]") {
  return "[[" + kind + "]]\npair = \"" + pair + "\"\n" +
         (direction.empty() ? "" : "direction = \"" + direction + "\"\n") + "value = " + value +
         "\nspread = " + spread + "\ncondition = \"c\"\nsource = \"s\"\n";
}

std::string error_of(const std::string& text) {
  const auto thresholds = parse_thresholds(text, "own.toml");
  REQUIRE(!thresholds);
  return thresholds.error().message();
}

bool says(const std::string& message, const std::string& part) {
  return message.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("the built-in thresholds are those of the literature") {
  const Thresholds& thresholds = builtin_thresholds();
  CHECK(thresholds.T(Pair::touch_sound) == 0.024);
  CHECK(thresholds.T(Pair::touch_sound, First::sound) == 0.024);
  CHECK(thresholds.T(Pair::sight_touch, First::sight) == 0.050);
  CHECK(thresholds.T(Pair::sight_touch, First::touch) == 0.015);
  CHECK(thresholds.T(Pair::sight_touch) == 0.015);
  CHECK(thresholds.T(Pair::sight_sound) == 0.045);
  CHECK(thresholds.T(Pair::picture_motion) == no_threshold);
  CHECK(thresholds.S(Pair::touch_sound) == 0.0056);
  CHECK(thresholds.S(Pair::picture_motion) == 0.0056);
  CHECK(thresholds.S(Pair::sight_sound) == no_threshold);
  for (const auto* list : {&thresholds.times, &thresholds.places})
    for (const Threshold& threshold : *list) {
      CHECK(threshold.low <= threshold.value);
      CHECK(threshold.value <= threshold.high);
      CHECK(!threshold.source.empty());
      CHECK(!threshold.condition.empty());
    }
}

TEST_CASE("a user's thresholds replace the pair and kind that they name, and only those") {
  const auto thresholds = parse_thresholds(
      entry("time", "sight-touch", "either") + entry("place", "sight-sound", ""), "own.toml");
  REQUIRE(thresholds);
  CHECK(thresholds->T(Pair::sight_touch) == 0.03);
  CHECK(thresholds->T(Pair::sight_touch, First::touch) == 0.03);
  CHECK(thresholds->S(Pair::sight_sound) == 0.03);
  CHECK(thresholds->T(Pair::touch_sound) == 0.024);
  CHECK(thresholds->S(Pair::touch_sound) == 0.0056);
  const auto none = parse_thresholds("", "own.toml");
  REQUIRE(none);
  CHECK(none->times.size() == builtin_thresholds().times.size());
}

TEST_CASE("a direction that a pair does not have has no threshold") {
  CHECK(builtin_thresholds().T(Pair::sight_touch, First::sound) == no_threshold);
}

TEST_CASE("thresholds are read from a file, and a missing one is an error") {
  const tests::TemporaryFolder folder;
  const auto path = folder.path / "own.toml";
  REQUIRE(write_file(path, entry("time", "sight-sound", "sound first") +
                               entry("time", "sight-sound", "sight first", "0.1", "[0.1, 0.1]")));
  const auto thresholds = load_thresholds(path);
  REQUIRE(thresholds);
  CHECK(thresholds->T(Pair::sight_sound, First::sight) == 0.1);
  CHECK(thresholds->T(Pair::sight_sound, First::sound) == 0.03);
  CHECK(!load_thresholds(folder.path / "none.toml"));
}

TEST_CASE("errors in a file of thresholds name the line and what would be right") {
  CHECK(says(error_of(entry("time", "sight-smell", "either")), "own.toml:2: "));
  CHECK(says(error_of(entry("time", "touch-sound", "sight first")), "has no direction \"sight first\""));
  CHECK(says(error_of(entry("time", "picture-motion", "either")), "place only"));
  CHECK(says(error_of(entry("time", "touch-sound", "")), "direction is missing"));
  CHECK(says(error_of(entry("place", "touch-sound", "either")), "direction"));
  CHECK(says(error_of(entry("time", "touch-sound", "either", "0")), "greater than 0"));
  CHECK(says(error_of(entry("time", "touch-sound", "either", "nan")), "own.toml:4"));
  CHECK(says(error_of(entry("time", "touch-sound", "either", "0.05")), "spread"));
  CHECK(says(error_of(entry("time", "touch-sound", "either", "\"24 ms\"")), "own.toml:4"));
  CHECK(says(error_of(entry("time", "sight-touch", "either") + entry("time", "sight-touch", "sight first")),
             "own.toml:9: "));
  CHECK(says(error_of(entry("time", "sight-touch", "sight first")), "add one for \"touch first\""));
  CHECK(says(error_of("[[times]]\n"), "own.toml:1"));
  CHECK(says(error_of("[[time]]\npair = \"touch-sound\"\n"), "value is missing"));
  CHECK(says(error_of("time = 3\n"), "own.toml:1"));
}

TEST_CASE(
    "a just noticeable difference is one at a threshold and adds time and place as a right angle does") {
  CHECK(jnd(0.024, 0, 0.024, 0.0056) == doctest::Approx(1));
  CHECK(jnd(0, -0.0056, 0.024, 0.0056) == doctest::Approx(1));
  CHECK(jnd(-3 * 0.024, 4 * 0.0056, 0.024, 0.0056) == doctest::Approx(5));
  CHECK(jnd(1, 0.0056, no_threshold, 0.0056) == doctest::Approx(1));
  CHECK(jnd(1, 1, no_threshold, no_threshold) == 0);
}
