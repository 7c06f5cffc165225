// The built-in materials: what a surface looks like, is shaped like and is made of, by name.
//
// Each is a recipe, materials/NAME.toml, held inside the program; the same text may come from a user's own
// file. A recipe is read strictly (every error names its line and key) and made into images of any size from
// 64 to 8192: seamless, the same look at every size, the same bytes for the same seed. The
// sixteen are those of the two studies (Sterling & Lin 2016, §1.4.2.1, §1.4.3.1). docs/materials.md has all
// keys.
//
// Thread: any. Cost: 0.1 to 0.3 s for 512 x 512 texels on one core, in proportion to the texels above that.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "intaglio/core/error.h"
#include "intaglio/surface/brick.h"
#include "intaglio/surface/builtin/recipe.h"

namespace intaglio::surface {

// The names, in the order of the studies.
std::vector<std::string> builtin_names();

// The built-in recipe of that name ("brick" is brick_running), or an error that names the nearest.
Result<BuiltinRecipe> find_builtin(std::string_view name);

// A recipe from TOML text; errors begin with `file_name` and the line. The material is named after the file.
Result<BuiltinRecipe> parse_builtin(std::string_view text, const std::string& file_name);

// The recipe that a texture's name asks for: a user's own file (.toml), or a built-in name. None where it names
// an image or a folder; an error that suggests a name where it is none of these.
Result<std::optional<BuiltinRecipe>> recipe_named(const std::string& texture);

// Texels a side, unless asked otherwise.
inline constexpr int builtin_size = 512;

// The images of a recipe: `size` texels a side, 64 to 8192. The slopes of the normals are those of the
// recipe's depth_fraction.
TextureImages make_texture(const BuiltinRecipe& recipe, int size);

}  // namespace intaglio::surface
