// Reading of recipes: every error names its line and key; own recipes are read like the built-in ones.
#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include "core/file.h"
#include "surface/recipes/builtin.h"
#include "tests/source_folder.h"

using namespace intaglio;
using namespace intaglio::surface;

namespace {

std::string error_of(const std::string& text) {
  const auto recipe = parse_recipe(text, "own.toml");
  return recipe ? "" : recipe.error().message();
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("every recipe file is embedded as it is") {
  std::size_t files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(tests::source_folder) / "materials")) {
    if (entry.path().extension() != ".toml") continue;
    ++files;
    const auto bytes = read_file(entry.path(), 1u << 20);
    REQUIRE(bytes.has_value());
    const auto own =
        parse_recipe({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, entry.path().string());
    REQUIRE_MESSAGE(own.has_value(), own.error().message());
    const auto embedded = find_builtin(own->about.name);
    REQUIRE(embedded.has_value());
    CHECK(embedded->about.title == own->about.title);
    CHECK(embedded->seed == own->seed);
    CHECK(embedded->layers.size() == own->layers.size());
  }
  CHECK(files == builtin_names().size());
  CHECK(files == 16);
}

TEST_CASE("the example of docs/materials.md is a recipe") {
  const auto bytes =
      read_file(std::filesystem::path(tests::source_folder) / "docs" / "materials.md", 1u << 20);
  REQUIRE(bytes.has_value());
  const std::string page(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  const std::string opening = "```toml\n";
  const std::size_t begin = page.find(opening) + opening.size();
  const auto recipe = parse_recipe(page.substr(begin, page.find("```", begin) - begin), "own.toml");
  REQUIRE_MESSAGE(recipe.has_value(), recipe.error().message());
  CHECK(recipe->about.title == "Terracotta");
  for (const std::string& name : builtin_names()) CHECK(contains(page, "| `" + name + "`"));
}

TEST_CASE("an empty recipe is a plain sheet") {
  const auto recipe = parse_recipe("", "folder/plain.toml");
  REQUIRE(recipe.has_value());
  CHECK(recipe->about.name == "plain");
  const TextureImages texture = make_texture(*recipe, 64);
  CHECK(texture.relief.at(0, 0, 3) == texture.relief.at(17, 40, 3));
  CHECK(texture.relief.at(9, 9, 2) == 65535);
}

TEST_CASE("an unknown name is answered with the nearest one") {
  const auto found = find_builtin("pebles");
  REQUIRE(!found.has_value());
  CHECK(contains(found.error().message(), "did you mean \"pebbles\"?"));
  CHECK(contains(found.error().message(), "wood_parquet"));
}

TEST_CASE("errors name the line, the key and a fix") {
  const struct {
    const char* text;
    const char* where;
    const char* says;
  } cases[] = {
      {"title = \"a\"\ndepht = 0.02\n", "own.toml:2", "did you mean \"depth\"?"},
      {"depth = 2\n", "own.toml:1", "depth is 2"},
      {"seed = 1.5\n", "own.toml:1", "seed is 1.5"},
      {"material = \"stele\"\n", "own.toml:1", "did you mean \"steel\"?"},
      {"material = { name = \"steel\", frction = 1 }\n", "own.toml:1", "friction"},
      {"[study]\nnumber = 11\n", "own.toml:2", "study.number is 11"},
      {"[layout]\npattern = \"bonds\"\n", "own.toml:2", "layout.pattern"},
      {"[layout]\npattern = \"sheet\"\nrows = 4\n", "own.toml:3", "layout.rows"},
      {"[layout]\npattern = \"bond\"\nrows = 7\nshift = 0.5\n", "own.toml:3", "even"},
      {"[layout]\npattern = \"weave\"\ncolumns = 5\n", "own.toml:3", "even"},
      {"[layout]\npattern = \"herringbone\"\ncolumns = 12\nlength = 4\n", "own.toml:3", "repeats after 8"},
      {"[layout]\npattern = \"scatter\"\nradius = [0.05, 0.01]\n", "own.toml:3", "smaller first"},
      {"[[layer]]\ndetail = \"grain\"\nalong = \"piece\"\n", "own.toml:3", "tile"},
      {"[layout]\npattern = \"lugs\"\ncolumns = 8\nradius = [0.01, 0.2]\n", "own.toml:4", "at most 0.087"},
      {"[profile]\nbevel = 0\n", "own.toml:2", "profile.bevel is 0"},
      {"[[layer]]\ndetail = \"noise\"\n\n[[layer]]\ndetail = \"noise\"\ncount = 3\n", "own.toml:6",
       "layer.count"},
      {"[[layer]]\nfrequency = [1.5, 2]\n", "own.toml:2", "not an integer"},
      {"[[layer]]\nfrequency = [256, 256]\noctaves = 4\n", "own.toml:2", "512"},
      {"[[layer]]\npaint = [0, 0, 300]\n", "own.toml:2", "sRGB"},
      {"[[layer]]\ndetail = \"rivets\"\ncount = 1\n", "own.toml:3", "rivets"},
      {"[colour]\npieces = [[1, 2]]\n", "own.toml:2", "3 numbers"},
      {"[colour]\npieces = [[1, 2, 3]]\n", "own.toml:2", "sRGB"},
      {"[colour\n", "own.toml:1", ""},
  };
  for (const auto& one : cases) {
    CAPTURE(one.text);
    const std::string error = error_of(one.text);
    CHECK(contains(error, one.where));
    CHECK_MESSAGE(contains(error, one.says), error);
  }
}

TEST_CASE("a recipe may override the material, its micro roughness too") {
  const auto recipe = parse_recipe(
      "material = { name = \"steel\", rayleigh_alpha = 40, micro = { rms_height = 3e-6 } }\n", "own.toml");
  REQUIRE(recipe.has_value());
  const Material& own = recipe->about.material;
  const Material steel = find_material("steel").value();
  CHECK(own.rayleigh_alpha == 40);
  CHECK(own.micro.rms_height == 3e-6);
  CHECK(own.youngs_modulus == steel.youngs_modulus);
  CHECK(own.micro.spectral_slope == steel.micro.spectral_slope);
}
