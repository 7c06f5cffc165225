// The brick by its few numbers: brick_running with those put in.

#include "surface/recipes/builtin.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <filesystem>
#include <vector>
#include <fmt/format.h>

#include "core/file.h"
#include "core/text.h"
#include "intaglio_materials.h"
#include "surface/recipes/painter.h"

namespace intaglio::surface {

TextureImages make_brick(const BrickRecipe& brick) {
  BuiltinRecipe recipe = find_builtin("brick_running").value();
  recipe.seed = brick.seed;
  recipe.about.depth_fraction = brick.depth_fraction;
  recipe.layout.columns = brick.columns;
  recipe.layout.rows = brick.rows;
  recipe.layout.joint = brick.joint;
  recipe.layout.corner = brick.corner_radius;
  recipe.profile.bevel = brick.bevel;
  return make_texture(recipe, brick.size);
}

// The recipes that the program holds, as materials/*.toml.

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

// From a recipe to images: depth and colour texel by texel, then normals by central differences of the depth.

namespace {

// The mean over a texel of `fine` x `fine` samples. A small image takes several, so that it shows what a
// large one shows and not what its texel centres happen to hit.
Sample texel(const Painter& painter, int x, int y, int size, int fine) {
  Sample sum;
  const double share = 1.0 / (fine * fine);
  for (int b = 0; b < fine; ++b) {
    for (int a = 0; a < fine; ++a) {
      const double u = (x + (a + 0.5) / fine) / size;
      const double v = 1 - (y + (b + 0.5) / fine) / size;  // row 0 = top
      const Sample one = painter.at(u, v);
      sum.depth += share * one.depth;
      sum.colour += share * one.colour;
    }
  }
  return sum;
}

// Depths of a tile, row 0 = top; indices wrap by one.
struct Depths {
  int size;
  std::vector<double> values = std::vector<double>(std::size_t(size) * std::size_t(size));

  double& at(int x, int y) {
    return values[std::size_t((y + size) % size) * std::size_t(size) + std::size_t((x + size) % size)];
  }
};

void write_relief(Depths& depths, double depth_fraction, Image16& relief) {
  const double slope = depth_fraction * depths.size / 2;  // of a central difference over two texels
  for (int y = 0; y < depths.size; ++y) {
    for (int x = 0; x < depths.size; ++x) {
      const double dz_du = -(depths.at(x + 1, y) - depths.at(x - 1, y)) * slope;
      const double dz_dv = -(depths.at(x, y - 1) - depths.at(x, y + 1)) * slope;
      const Vec3 normal = Vec3(-dz_du, -dz_dv, 1).normalized();
      for (int c = 0; c < 3; ++c) {
        relief.at(x, y, c) = static_cast<std::uint16_t>(std::lround((0.5 * normal[c] + 0.5) * 65535));
      }
      relief.at(x, y, 3) = static_cast<std::uint16_t>(std::lround(depths.at(x, y) * 65535));
    }
  }
}

}  // namespace

TextureImages make_texture(const BuiltinRecipe& recipe, int size) {
  assert(size >= 64 && size <= 8192);
  constexpr int full_detail = 512;
  const int fine = (full_detail + size - 1) / size;
  const Painter painter(recipe);
  TextureImages out{Image16(size, size, 4), Image8(size, size, 3)};
  Depths depths{size};
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const Sample sample = texel(painter, x, y, size, fine);
      depths.at(x, y) = sample.depth;
      for (int c = 0; c < 3; ++c) {
        out.colour.at(x, y, c) = static_cast<std::uint8_t>(std::lround(sample.colour[c] * 255));
      }
    }
  }
  write_relief(depths, recipe.about.depth_fraction, out.relief);
  return out;
}

}  // namespace intaglio::surface
