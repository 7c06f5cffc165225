#include <doctest/doctest.h>

#include <string>

#include "intaglio/session/scene.h"

using namespace intaglio;
using namespace intaglio::session;

namespace {

std::string error_of(const std::string& text) {
  const auto scene = parse_scene(text, "s.toml");
  return scene ? "" : scene.error().message();
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("the scenes of the project are read") {
  const auto scene = read_scene(std::string(INTAGLIO_SOURCE_DIR) + "/scenes/brick.toml");
  REQUIRE_MESSAGE(scene, (scene ? "" : scene.error().message()));
  CHECK(scene->duration >= 8);
  CHECK(scene->balls.size() == 1);
  CHECK(scene->pen.has_value());
}

TEST_CASE("an empty file is a scene of defaults") {
  const auto scene = parse_scene("", "s.toml");
  REQUIRE(scene);
  CHECK(scene->balls.empty());
  CHECK_FALSE(scene->pen.has_value());
}

TEST_CASE("an unknown key names its line and the nearest known key") {
  const std::string error = error_of("title = \"x\"\n[[ball]]\nraduis = 0.1\n");
  CHECK(has(error, "s.toml:3"));
  CHECK(has(error, "ball.raduis"));
  CHECK(has(error, "\"radius\""));
  CHECK(has(error_of("[phisics]\nrate = 100\n"), "physics"));
}

TEST_CASE("values that make no sense are errors with line and what would be right") {
  const struct {
    const char* text;
    const char* line;
    const char* part;
  } cases[] = {
      {"[[ball]]\nradius = nan\n", "s.toml:2", "finite"},
      {"[[ball]]\n\nmass = -1\n", "s.toml:3", "greater than 0"},
      {"[[ball]]\nposition = [0, inf, 0]\n", "s.toml:2", "finite"},
      {"[[ball]]\nposition = [0, 1]\n", "s.toml:2", "three numbers"},
      {"[[ball]]\nmaterial = \"brik\"\n", "s.toml:2", "\"brick\""},
      {"[[ball]]\nmaterial = { name = \"steel\", density = -5 }\n", "s.toml:2", "density"},
      {"[surface]\nrepresentation = \"bumpy\"\n", "s.toml:2", "relief"},
      {"[surface]\nsize = [0, 1]\n", "s.toml:2", "0.01"},
      {"duration = \"long\"\n", "s.toml:1", "number"},
      {"[surface]\nbase = { shape = \"bowl\" }\n", "s.toml:2", "surface.base"},
      {"[[ground]]\nbase = \"bowl\"\n", "s.toml:2", "table"},
      {"[[ground]]\nbase = { shape = \"cone\" }\n", "s.toml:2", "bowl"},
      {"[[ground]]\nbase = { radius = 0 }\n", "s.toml:2", "0.01"},
      {"[[ground]]\nbase = { repeat = [1.5, 2] }\n", "s.toml:2", "whole"},
      {"[[ground]]\nbase = { shape = \"mesh\" }\n", "s.toml:2", "file"},
      {"[[body]]\nshape = \"cylinder\"\ntop = { texture = \"brick\" }\n", "s.toml:3", "no top"},
      {"[[body]]\nskin = { texture = \"brick\" }\n", "s.toml:2", "no skin"},
      {"[[body]]\nbottom = { textur = \"brick\" }\n", "s.toml:2", "\"texture\""},
      {"[[body]]\nshape = \"sphere\"\nskin = { repeat = [0, 1] }\n", "s.toml:3", "1 to 64"},
      {"seed = 1.5\n", "s.toml:1", "whole"},
      {"[video]\nwidth = 641\n", "s.toml:2", "even"},
      {"[pen]\nlength = 0.1\n", "s.toml:1", "waypoint"},
      {"[pen]\npath = [[0, 0, 0, 0], [0, 0, 0, 0]]\n", "s.toml:2", "increase"},
      {"[pen]\npath = [[0, 0, 0]]\n", "s.toml:2", "4 numbers"},
      {"[pen]\ndirection = [0, 0, 0]\npath = [[0, 0, 0, 0]]\n", "s.toml:2", "direction"},
      {"light = [0, 0, 0]\n", "s.toml:1", "direction"},
      {"[pen]\nramp_in = 0.1\npath = [[0, 0, 0, 0]]\n", "s.toml:2", "safety"},
      {"surface = 3\n", "s.toml:1", "table"},
      {"ball = [1, 2]\n", "s.toml:1", "[[ball]]"},
      {"title = \"x\n", "s.toml:1", ""},
      {"a = 1\na = 2\n", "s.toml:2", ""},
      {"title = \"\u00e9 is fine in quotes\" # \u00e9 and here\n\u00e9 = 1\n", "s.toml:2", ""},
  };
  for (const auto& c : cases) {
    const std::string error = error_of(c.text);
    CHECK_MESSAGE(has(error, c.line), c.text << " -> " << error);
    CHECK_MESSAGE(has(error, c.part), c.text << " -> " << error);
    CHECK(error.find('\n') == std::string::npos);
  }
}

TEST_CASE("a ball's mass overrides its density") {
  const auto scene = parse_scene("[[ball]]\nradius = 0.1\nmaterial = \"steel\"\nmass = 2\n", "s.toml");
  REQUIRE(scene);
  CHECK(scene->balls[0].mass() == doctest::Approx(2));
}

TEST_CASE("curved grounds and textured bodies are read, each relief in its body's frame") {
  const auto scene = parse_scene(R"(
[[ground]]
texture = "pebbles"
base = { shape = "cylinder", radius = 0.2, height = 1.5, repeat = [3, 2] }
[[body]]
shape = "box"
size = [0.2, 0.1, 0.4]
top = { texture = "brick", depth = 0.01 }
[body.bottom]
texture = "stone_flags"
depth = 0.02
[[body]]
shape = "sphere"
radius = 0.07
skin = { texture = "metal_studs", repeat = [2, 1] }
[[body]]
)",
                                 "s.toml");
  REQUIRE_MESSAGE(scene, (scene ? "" : scene.error().message()));
  REQUIRE(scene->grounds.size() == 1);
  REQUIRE(scene->grounds[0].base);
  CHECK(scene->grounds[0].base->shape == BaseScene::Shape::cylinder);
  CHECK(scene->grounds[0].base->repeat == Vec2(3, 2));
  REQUIRE(scene->bodies.size() == 3);
  REQUIRE(scene->bodies[0].reliefs.size() == 2);
  CHECK(scene->bodies[0].reliefs[0].position == Vec3(0, 0.05, 0));
  CHECK(scene->bodies[0].reliefs[0].size == Vec2(0.2, 0.4));
  CHECK((rotation_of(scene->bodies[0].reliefs[1].rotation) * Vec3::UnitY() + Vec3::UnitY()).norm() < 1e-12);
  REQUIRE(scene->bodies[1].reliefs.size() == 1);
  REQUIRE(scene->bodies[1].reliefs[0].base);
  CHECK(scene->bodies[1].reliefs[0].base->radius == 0.07);
  CHECK(scene->bodies[2].reliefs.empty());
}
