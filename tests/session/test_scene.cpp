#include <doctest/doctest.h>

#include <fmt/format.h>
#include <algorithm>
#include <string>

#include "scene/scene.h"
#include "scene/surfaces.h"
#include "tests/source_folder.h"

using namespace intaglio;
using namespace intaglio::scene;

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
  const auto scene = read_scene(std::string(tests::source_folder) + "/scenes/brick.toml");
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

TEST_CASE("invalid values are errors with their line and the fix") {
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
      {"[[ground]]\nbase = { repeat = [1.5, 2] }\n", "s.toml:2", "integers"},
      {"[[ground]]\nbase = { shape = \"mesh\" }\n", "s.toml:2", "file"},
      {"[[body]]\nshape = \"cylinder\"\ntop = { texture = \"brick\" }\n", "s.toml:3", "no top"},
      {"[[body]]\nskin = { texture = \"brick\" }\n", "s.toml:2", "no skin"},
      {"[[body]]\nbottom = { textur = \"brick\" }\n", "s.toml:2", "\"texture\""},
      {"[[body]]\nshape = \"sphere\"\nskin = { repeat = [0, 1] }\n", "s.toml:3", "1 to 64"},
      {"[[ground]]\nbase = { file = \"a.obj\" }\n", "s.toml:2", "a bowl does not use ground.base.file"},
      {"[[ground]]\nbase = { shape = \"sphere\", height = 1 }\n", "s.toml:2", "radius, repeat"},
      {"[[ground]]\nbase = { shape = \"mesh\", file = \"a.obj\", radius = 1 }\n", "s.toml:2",
       "a mesh does not use"},
      {"[[ground]]\nsize = [1, 1]\nbase = {}\n", "s.toml:2", "size"},
      {"[[ground]]\nrepresentation = \"flat\"\n", "s.toml:2", "set on the floor"},
      {"[[body]]\nradius = 0.1\n", "s.toml:2", "a box does not use"},
      {"[[body]]\nshape = \"cylinder\"\nletter = \"B\"\n", "s.toml:3", "radius, height"},
      {"[[body]]\nsweep = 20\n", "s.toml:2", "makes a flipper"},
      {"[[body]]\nkey = \"left\"\nvelocity = [1, 0, 0]\n", "s.toml:3", "flipper"},
      {"[[body]]\nmotion = \"fixed\"\nspin = [1, 0, 0]\n", "s.toml:3", "fixed"},
      {"[surface]\nthickness = 1e-9\n", "s.toml:2", "between 0.001 m and 10 m"},
      {"seed = 1.5\n", "s.toml:1", "an integer"},
      {"[video]\nwidth = 641\n", "s.toml:2", "even"},
      {"[pen]\nlength = 0.1\n", "s.toml:1", "waypoint"},
      {"[pen]\npath = [[0, 0, 0, 0], [0, 0, 0, 0]]\n", "s.toml:2", "increase"},
      {"[pen]\npath = [[-5, 0, 0, 0]]\n", "s.toml:2", "between 0 s and 100000 s"},
      {"[pen]\npath = [[0, 0, 1e9, 0]]\n", "s.toml:2", "1e+09 m"},
      {"[pen]\ndevice_workspace = [1, -1, 1]\npath = [[0, 0, 0, 0]]\n", "s.toml:2", "0.001 m and 10 m"},
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

TEST_CASE("unusable textures and bases are errors at the scene's line, with file and reason") {
  const std::string sheet = std::string(tests::source_folder) + "/tests/CMakeLists.txt";
  const struct {
    std::string text;
    const char* line;
    const char* part;
  } cases[] = {
      {"[surface]\nsize = [1, 1]\ntexture = \"none.png\"\n", "s.toml:3", "none.png: no such file"},
      {"[[ground]]\n\ntexture = \"brik\"\n", "s.toml:3", "brick_running"},
      {"[[ground]]\ntexture = \"brick\"\n[ground.base]\nshape = \"mesh\"\nfile = \"none.obj\"\n", "s.toml:5",
       "none.obj: no such file"},
      {"[[ground]]\n[ground.base]\nshape = \"mesh\"\nfile = \"" + sheet + "\"\n", "s.toml:4", ".obj"},
      {"[[ground]]\ndepth = 5\n[ground.base]\nshape = \"cylinder\"\n", "s.toml:3", "depth"},
      {"[[body]]\nshape = \"sphere\"\nskin = { texture = \"none.png\" }\n", "s.toml:3", "none.png"},
      {"[[body]]\nshape = \"sphere\"\n[body.skin]\ndepth = 1\n", "s.toml:3", "depth"},
      {"[[body]]\n[body.top]\n\ntexture = \"none.png\"\n", "s.toml:4", "none.png"},
      {"[[body]]\n[body.bottom]\ndepth = 0.5\n", "s.toml:2", "thick"},
  };
  for (const auto& c : cases) {
    const auto scene = parse_scene(c.text, "s.toml");
    REQUIRE_MESSAGE(scene, c.text);
    const auto made = make_surface(*scene);
    const std::string error = made ? "" : made.error().message();
    CHECK_MESSAGE(error.rfind(std::string(c.line) + ": ", 0) == 0, c.text << " -> " << error);
    CHECK_MESSAGE(has(error, c.part), c.text << " -> " << error);
  }
}

TEST_CASE("a texture too fine for contact on its base is an error; a fine one gets a warning") {
  const auto made = [](int repeat, double depth) {
    const auto scene =
        parse_scene(fmt::format("[[ball]]\nradius = 0.045\n[[ground]]\ntexture = \"pebbles\"\ndepth = {}\n"
                                "base = {{ radius = 0.3, repeat = [{}, {}] }}\n",
                                depth, repeat, repeat),
                    "s.toml");
    REQUIRE(scene);
    return make_surface(*scene);
  };
  const auto refused = made(64, 0.01);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().message().rfind("s.toml:6: a ball of radius 0.045 m covers 4.", 0) == 0);
  CHECK(has(refused.error().message(), "reduce repeat or depth"));
  const auto slow = made(64, 0.001), quick = made(4, 0.01);
  REQUIRE(slow);
  REQUIRE(quick);
  const auto says = [](const SceneSurface& surface) {
    return std::any_of(surface.notes.begin(), surface.notes.end(),
                       [](const std::string& note) { return has(note, "steps will be slow"); });
  };
  CHECK(says(*slow));
  CHECK_FALSE(says(*quick));
  // As many texels as lie in the cap, whichever way they are cut up.
  CHECK(covered_texels(slow->grounds[0], 0.09) ==
        doctest::Approx(2 * covered_texels(slow->grounds[0], 0.045)));
  CHECK(covered_texels(*slow, 0.045) == 0);
}

TEST_CASE("replacing a texture clears the settings of the old one") {
  auto scene = parse_scene("[surface]\ntexture = \"a.png\"\ngreen = \"-Y\"\ndepth = 0.1\n", "s.toml");
  REQUIRE(scene);
  put_texture(scene->surface, "none.png");
  CHECK_FALSE(scene->surface.green);
  CHECK_FALSE(scene->surface.depth);
  const auto made = make_surface(*scene);
  REQUIRE_FALSE(made);
  CHECK(made.error().message().rfind("none.png: no such file", 0) == 0);
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
  CHECK(scene->grounds[0].base->shape == BaseSettings::Shape::cylinder);
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
