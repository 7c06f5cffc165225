// The recipes that the program holds, as materials/*.toml.
#include <algorithm>
#include <filesystem>

#include "intaglio/core/file.h"
#include "intaglio/surface/builtin/builtin.h"
#include "intaglio_materials.h"

namespace intaglio::surface {

namespace {

// All of them, in the order of the studies. A broken one cannot be shipped: a test reads them all.
const std::vector<BuiltinRecipe>& library() {
  static const std::vector<BuiltinRecipe> all = [] {
    std::vector<BuiltinRecipe> recipes;
    for (const auto& [name, text] : materials::all) {
      recipes.push_back(parse_builtin(text, "materials/" + std::string(name) + ".toml").value());
    }
    const auto order = [](const BuiltinRecipe& r) { return std::pair(r.about.study, r.about.study_number); };
    std::stable_sort(recipes.begin(), recipes.end(),
                     [&](const BuiltinRecipe& a, const BuiltinRecipe& b) { return order(a) < order(b); });
    return recipes;
  }();
  return all;
}

}  // namespace

std::vector<std::string> builtin_names() {
  std::vector<std::string> names;
  for (const BuiltinRecipe& recipe : library()) names.push_back(recipe.about.name);
  return names;
}

Result<BuiltinRecipe> find_builtin(std::string_view name) {
  const std::string wanted = name == "brick" ? "brick_running" : std::string(name);
  for (const BuiltinRecipe& recipe : library()) {
    if (recipe.about.name == wanted) return recipe;
  }
  const std::vector<std::string> names = builtin_names();
  const std::string nearest = nearest_name(wanted, names);
  return fail("", fmt::format("no built-in material is called \"{}\"", wanted),
              fmt::format("{}known: {}", nearest.empty() ? "" : "did you mean \"" + nearest + "\"? ",
                          fmt::join(names, ", ")));
}

Result<std::optional<BuiltinRecipe>> recipe_named(const std::string& texture) {
  std::error_code ignored;
  const std::filesystem::path path(texture);
  if (path.extension() == ".toml") {
    const auto bytes = read_file(path, 1u << 20);
    if (!bytes) return tl::unexpected(bytes.error());
    return parse_builtin({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, texture);
  }
  if (std::filesystem::exists(path, ignored) || path.has_parent_path() || path.has_extension())
    return std::nullopt;
  return find_builtin(texture);
}

}  // namespace intaglio::surface
