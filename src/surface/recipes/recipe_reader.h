// How the parts of a recipe's file are read; the keys are explained in docs/materials.md.
#pragma once

#include <vector>

#include "core/toml.h"
#include "surface/recipes/recipe.h"

namespace intaglio::surface {

inline constexpr Range share{0, 1, false, "it must be between 0 and 1"};
inline constexpr Range signed_share{-1, 1, false, "it must be between -1 and 1"};
inline constexpr Range small_length{0, 0.5, false,
                                    "a length is a fraction of the tile's side, between 0 and 0.5"};
inline constexpr Range some_length{0.0005, 0.5, false,
                                   "a length is a fraction of the tile's side, between 0.0005 and 0.5"};
inline constexpr Range lattice{1, 256, false, "it must be a whole number between 1 and 256"};

void read_layout(TomlReader& reader, LayoutRecipe& layout);
// Appends a layer; which details make sense depends on the pattern of the layout.
void read_layer(TomlReader& reader, Pattern pattern, std::vector<LayerRecipe>& layers);
void read_colour(TomlReader& reader, const char* key, Vec3& colour);

}  // namespace intaglio::surface
