#include <doctest/doctest.h>

#include "window/script.h"

using namespace intaglio;
using namespace intaglio::window;

TEST_CASE("a script's times, verbs, arguments and comments are parsed") {
  const auto events = parse_script(
      "# a test\n0.5 key Space\n\n1 move 0.25 0.75  # there\n1.0 down left\n2 drop my wall.png\n2 set pen 1\n"
      "2.5 point 2\n3 wheel -2\n3.5 resize 640 360\n4 quit\n",
      "t");
  REQUIRE(events);
  REQUIRE(events->size() == 9);
  CHECK((*events)[0].verb == ScriptVerb::key);
  CHECK((*events)[0].text == "Space");
  CHECK((*events)[1].x == 0.25);
  CHECK((*events)[1].y == 0.75);
  CHECK((*events)[3].text == "my wall.png");
  CHECK((*events)[4].text == "pen");
  CHECK((*events)[4].x == 1);
  CHECK((*events)[5].verb == ScriptVerb::point);
  CHECK((*events)[5].x == 2);
  CHECK((*events)[6].x == -2);
  CHECK((*events)[8].verb == ScriptVerb::quit);
  CHECK((*events)[8].where.ends_with(":11"));
}

TEST_CASE("a bad script is refused by an error that names its line") {
  const auto refused = [](const char* text, const char* expected) {
    const auto events = parse_script(text, "t");
    REQUIRE_FALSE(events);
    const std::string message = events.error().message();
    CHECK_MESSAGE(message.find(expected) != std::string::npos, message);
    CHECK(message.find('\n') == std::string::npos);
  };
  refused("x quit\n", "t:1: \"x\" is not a time");
  refused("nan quit\n", "is not a time");
  refused("-1 quit\n", "is not a time");
  refused("1 quit\n0.5 quit\n", "t:2: is earlier than the line before");
  refused("1 qiut\n", "did you mean \"quit\"");
  refused("1 move 0.5\n", "write: 1 move X Y");
  refused("1 move 0.5 inf\n", "wrong arguments");
  refused("1 quit now\n", "wrong arguments");
  refused("1 down thumb\n", "unknown mouse button");
  refused("1 drop\n", "wrong arguments");
  refused("0 quit\n1 point -1\n", "t:2: \"point\": -1 is out of range; point BODY: an integer from 0");
  refused("1 point 1.5\n", "integer");
  refused("1 resize 0 0\n", "t:1: \"resize\": 0 is out of range; resize W H: an integer from 16 to 7680");
  refused("1 resize 640 1e9\n", "from 16 to 4320");
  refused("1 move 1.5 0\n", "from 0 to 1");
  refused("1 wheel 1e30\n", "from -100 to 100");
  refused("1 set depth -5\n", "t:1: depth is -5; it must be between 0 and 10, or -1 for the scene's value");
  refused("1 set samples 1.5\n", "an integer from 1 to 4");
  refused("1 set pen 2\n", "an integer from 0 to 1");
  refused("1 set dept 1\n", "did you mean \"depth\"");
  refused("1 key Spase\n", "t:1: unknown key \"Spase\"");
  refused("1 hold nothing\n", "unknown key");
  refused("1 device Phantom0\n", "t:1: ");
  refused("1 device a@b:99999\n", "t:1: ");
  refused("1 screenshot a.jpg\n", "end the name with .png");
}

TEST_CASE("a script may use both ends of every range") {
  CHECK(
      parse_script("1 point 0\n1 resize 16 16\n1 resize 7680 4320\n1 set depth -1\n1 set depth 0\n"
                   "1 set representation -1\n1 set speed 0.01\n1 move 0 1\n1 device mouse\n"
                   "1 device Phantom0@127.0.0.1:3883\n1 screenshot a.PNG\n",
                   "t"));
}
