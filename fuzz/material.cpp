// Any text as the recipe of a built-in material: a recipe or one clear error on one line.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "surface/recipes/builtin.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto recipe =
      intaglio::surface::parse_recipe({reinterpret_cast<const char*>(data), size}, "fuzz.toml");
  if (recipe) return 0;
  const std::string message = recipe.error().message();
  if (message.find('\n') != std::string::npos || message.find("fuzz.toml") != 0) std::abort();
  return 0;
}
