#include <doctest/doctest.h>

#include "intaglio/window/script.h"

using namespace intaglio;
using namespace intaglio::window;

TEST_CASE("a script reads as it is written: times, verbs, arguments, comments") {
  const auto events = parse_script(
      "# a test\n0.5 key Space\n\n1 move 0.25 0.75  # there\n1.0 down left\n2 drop my wall.png\n2 set pen 1\n"
      "2.5 point 2\n3 wheel -2\n3.5 resize 640 360\n4 quit\n",
      "t");
  REQUIRE(events);
  REQUIRE(events->size() == 9);
  CHECK((*events)[0].verb == Verb::key);
  CHECK((*events)[0].text == "Space");
  CHECK((*events)[1].x == 0.25);
  CHECK((*events)[1].y == 0.75);
  CHECK((*events)[3].text == "my wall.png");
  CHECK((*events)[4].text == "pen");
  CHECK((*events)[4].x == 1);
  CHECK((*events)[5].verb == Verb::point);
  CHECK((*events)[5].x == 2);
  CHECK((*events)[6].x == -2);
  CHECK((*events)[8].verb == Verb::quit);
  CHECK((*events)[8].line == 11);
}

TEST_CASE("a bad script is refused in one line that names the line") {
  const auto refused = [](const char* text, const char* says) {
    const auto events = parse_script(text, "t");
    REQUIRE_FALSE(events);
    const std::string message = events.error().message();
    CHECK_MESSAGE(message.find(says) != std::string::npos, message);
    CHECK(message.find('\n') == std::string::npos);
  };
  refused("x quit\n", "t:1: \"x\" is no time");
  refused("nan quit\n", "is no time");
  refused("-1 quit\n", "is no time");
  refused("1 quit\n0.5 quit\n", "t:2: goes back in time");
  refused("1 qiut\n", "did you mean \"quit\"");
  refused("1 move 0.5\n", "write: 1 move X Y");
  refused("1 move 0.5 inf\n", "wrong arguments");
  refused("1 quit now\n", "wrong arguments");
  refused("1 down thumb\n", "no mouse button");
  refused("1 drop\n", "wrong arguments");
}
