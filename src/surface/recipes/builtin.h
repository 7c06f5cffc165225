// The built-in materials: appearance, shape and material, by name.
//
// Each is a recipe, materials/NAME.toml, embedded in the program; a user's own file may hold the same text. A
// recipe is read strictly (every error names its line and key) and turned into images of any size from 64 to
// 8192: seamless, the same look at every size, the same bytes for the same seed. The sixteen are those of the
// two studies (Sterling & Lin 2016, §1.4.2.1, §1.4.3.1). docs/materials.md lists all keys.
//
// Any thread. Cost: 0.1 to 0.3 s for 512 x 512 texels on one core, in proportion to the texels above that.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/image.h"
#include "surface/recipes/recipe.h"

namespace intaglio::surface {

// A texture in the form of files: `relief` is 16-bit RGBA, normal (+Y) in RGB and depth (0 = top) in
// alpha; `colour` is 8-bit sRGB. Row 0 = top.
struct TextureImages {
  Image16 relief;
  Image8 colour;
};

// The names, in the order of the studies; the alias "brick" is not among them.
std::vector<std::string> builtin_names();

// The built-in recipe of this name ("brick" is brick_running), or an error suggesting the closest name.
Result<Recipe> find_builtin(std::string_view name);

// Parses a recipe; errors begin with `file_name` and the line. The material is named after the file.
Result<Recipe> parse_recipe(std::string_view text, const std::string& file_name);

// The recipe that `texture` names: a recipe file (.toml), or a built-in name. Empty when it names an image or
// a folder; otherwise an error suggesting the closest name.
Result<std::optional<Recipe>> find_recipe(const std::string& texture);

// Texels per side.
inline constexpr int default_texture_size = 512, min_texture_size = 64, max_texture_size = 8192;

// Whether make_texture takes this size; the error names `where` it is set.
Result<void> check_texture_size(int size, const std::string& where);

// The images of a recipe, with `size` texels per side, 64 to 8192. The slopes of the normals are for the
// recipe's depth_fraction.
TextureImages make_texture(const Recipe& recipe, int size);

// The built-in brick with these parameters overridden; lengths are fractions of the tile's side.
struct BrickRecipe {
  int size = 512;  // texels per side
  int columns = 4;
  int rows = 8;          // even, so that the running bond is seamless
  double joint = 0.018;  // width of the mortar's floor
  double bevel = 0.010;  // width of the slope from the mortar to the brick's face
  double corner_radius = 0.014;
  double depth_fraction = 0.02;  // full depth over the tile's side: fixes the slopes of the normals
  std::uint64_t seed = 7;
};

TextureImages make_brick(const BrickRecipe& recipe);

}  // namespace intaglio::surface
