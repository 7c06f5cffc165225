// Any text as the recipe of a built-in texture, and as a material: each, or one clear error on one line. An
// accepted material is a solid that rings.
#include <cmath>

#include "core/toml.h"
#include "fuzz/require.h"
#include "surface/recipes/builtin.h"

using namespace intaglio;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto text = fuzz::as_text(data, size);
  const auto recipe = surface::parse_recipe(text, "fuzz.toml");
  if (!recipe) fuzz::require_clear(recipe.error(), "fuzz.toml");
  const auto material = parse_material(text, "fuzz.toml");
  if (!material) fuzz::require_clear(material.error(), "fuzz.toml");
  if (material)
    fuzz::require(material->density > 0 && material->youngs_modulus > 0 &&
                  std::isfinite(material->shear_modulus()));
  return 0;
}
