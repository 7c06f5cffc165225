#include "surface/recipes/builtin.h"

#include <fmt/format.h>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <filesystem>
#include <vector>

#include "core/file.h"
#include "core/text.h"
#include "intaglio_materials.h"
#include "surface/recipes/painter.h"
#include "surface/texels.h"

namespace intaglio::surface {

namespace {

// The embedded recipes, in the order of the studies. value() is safe: a test parses every one.
const std::vector<Recipe>& library() {
  static const std::vector<Recipe> all = [] {
    std::vector<Recipe> recipes;
    for (const auto& [name, text] : materials::all) {
      recipes.push_back(parse_recipe(text, "materials/" + std::string(name) + ".toml").value());
    }
    const auto order = [](const Recipe& r) { return std::pair(r.about.study, r.about.study_number); };
    std::stable_sort(recipes.begin(), recipes.end(),
                     [&](const Recipe& a, const Recipe& b) { return order(a) < order(b); });
    return recipes;
  }();
  return all;
}

}  // namespace

std::vector<std::string> builtin_names() {
  std::vector<std::string> names;
  for (const Recipe& recipe : library()) names.push_back(recipe.about.name);
  return names;
}

Result<Recipe> find_builtin(std::string_view name) {
  const std::string wanted = name == "brick" ? "brick_running" : std::string(name);
  for (const Recipe& recipe : library()) {
    if (recipe.about.name == wanted) return recipe;
  }
  std::vector<std::string> names = builtin_names();
  names.push_back("brick");
  const std::string nearest = nearest_name(wanted, names);
  return fail("", fmt::format("no built-in texture is called \"{}\"", wanted),
              fmt::format("{}known: {}", nearest.empty() ? "" : "did you mean \"" + nearest + "\"? ",
                          fmt::join(names, ", ")));
}

Result<void> check_texture_size(int size, const std::string& where) {
  if (size >= min_texture_size && size <= max_texture_size) return {};
  return fail(where, fmt::format("a generated texture cannot have {} texels a side", size),
              fmt::format("{} to {} are possible", min_texture_size, max_texture_size));
}

Result<std::optional<Recipe>> find_recipe(const std::string& texture) {
  std::error_code ignored;
  const std::filesystem::path path(texture);
  if (path.extension() == ".toml") {
    const auto text = read_text(path, 1u << 20);
    if (!text) return tl::unexpected(text.error());
    return parse_recipe(*text, texture);
  }
  if (std::filesystem::exists(path, ignored) || path.has_parent_path() || path.has_extension())
    return std::nullopt;
  return find_builtin(texture);
}

namespace {

// The mean over a texel of `fine` x `fine` samples. A small image takes several per texel, so that it matches
// a downsampled large image instead of aliasing.
PaintedPoint texel(const Painter& painter, int x, int y, int size, int fine) {
  PaintedPoint sum;
  const double share = 1.0 / (fine * fine);
  for (int b = 0; b < fine; ++b) {
    for (int a = 0; a < fine; ++a) {
      const double u = (x + (a + 0.5) / fine) / size;
      const double v = 1 - (y + (b + 0.5) / fine) / size;  // row 0 = top
      const PaintedPoint one = painter.at(u, v);
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
        relief.at(x, y, c) = encode_component(normal[c]);
      }
      relief.at(x, y, 3) = std::uint16_t(std::lround(depths.at(x, y) * 65535));
    }
  }
}

}  // namespace

TextureImages make_texture(const Recipe& recipe, int size) {
  assert(size >= 64 && size <= 8192);
  constexpr int full_detail = 512;
  const int fine = (full_detail + size - 1) / size;
  const Painter painter(recipe);
  TextureImages out{Image16(size, size, 4), Image8(size, size, 3)};
  Depths depths{size};
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const PaintedPoint sample = texel(painter, x, y, size, fine);
      depths.at(x, y) = sample.depth;
      for (int c = 0; c < 3; ++c) {
        out.colour.at(x, y, c) = std::uint8_t(std::lround(sample.colour[c] * 255));
      }
    }
  }
  write_relief(depths, recipe.about.depth_fraction, out.relief);
  return out;
}

TextureImages make_brick(const BrickRecipe& brick) {
  Recipe recipe = find_builtin("brick_running").value();
  recipe.seed = brick.seed;
  recipe.about.depth_fraction = brick.depth_fraction;
  recipe.layout.columns = brick.columns;
  recipe.layout.rows = brick.rows;
  recipe.layout.joint = brick.joint;
  recipe.layout.corner = brick.corner_radius;
  recipe.profile.bevel = brick.bevel;
  return make_texture(recipe, brick.size);
}

}  // namespace intaglio::surface
