#include <doctest/doctest.h>

#include <array>
#include <string>
#include <vector>

#include "core/text.h"
#include "intaglio/error.h"
#include "intaglio/material.h"

using namespace intaglio;

TEST_CASE("an error is one line with place, fault and fix") {
  const Error error{"a.toml:3", "mass is\n-1", "greater than 0"};
  CHECK(error.message() == "a.toml:3: mass is -1; greater than 0");
}

TEST_CASE("edit distance is a metric on a set of words") {
  const std::vector<std::string> words{"", "a", "radius", "radios", "raduis", "mass", "masses", "position"};
  for (const auto& a : words) {
    CHECK(edit_distance(a, a) == 0);
    for (const auto& b : words) {
      CHECK(edit_distance(a, b) == edit_distance(b, a));
      for (const auto& c : words) CHECK(edit_distance(a, c) <= edit_distance(a, b) + edit_distance(b, c));
    }
  }
}

TEST_CASE("a misspelt material names the nearest one") {
  const auto found = find_material("brik");
  REQUIRE_FALSE(found);
  CHECK(found.error().message().find("did you mean \"brick\"") != std::string::npos);
}

TEST_CASE("a word that is like none of the names suggests none") {
  for (const char* word : {"foo", "x", "", "velvet"}) {
    const auto found = find_material(word);
    REQUIRE_FALSE(found);
    CAPTURE(word);
    CHECK(found.error().message().find("did you mean") == std::string::npos);
    CHECK(found.error().message().find("known: ceramic") != std::string::npos);
  }
  const std::vector<std::string> names{"r", "at", "quit"};
  CHECK(nearest_name("s", names).empty());
  CHECK(nearest_name("a", names) == "at");
  CHECK(nearest_name("qiut", names) == "quit");
}
