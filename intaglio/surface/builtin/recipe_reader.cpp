#include "intaglio/surface/builtin/recipe_reader.h"

#include <filesystem>

#include "intaglio/core/material_reader.h"
#include "intaglio/surface/builtin/builtin.h"

namespace intaglio::surface {

namespace {

void read_study(TomlReader& r, BuiltinMaterial& about) {
  int study = 0;
  r.choice("name", {"none", "identification", "comparison"}, study);
  about.study = static_cast<Study>(study);
  r.whole("number", about.study_number,
          {1, 10, false, "the identification study has 1 to 10, the comparison 1 to 6"});
}

void read_profile(TomlReader& r, ProfileRecipe& p) {
  r.number("bevel", p.bevel, some_length);
  r.number("wear", p.wear, share);
  r.number("face", p.face, share);
  r.number("joint", p.joint, share);
  r.number("lift", p.lift, share);
  r.number("tilt", p.tilt, share);
  r.number("crown", p.crown, share);
}

void read_paint(TomlReader& r, ColourRecipe& c) {
  std::vector<std::vector<double>> rows;
  r.rows("pieces", 3, rows);
  if (!rows.empty()) c.pieces.clear();
  for (const auto& row : rows) {
    c.pieces.emplace_back(row[0], row[1], row[2]);
    if (c.pieces.back().minCoeff() < 0 || c.pieces.back().maxCoeff() > 1) {
      r.fail_at("pieces", "pieces has a colour outside 0..1", "sRGB in 0..1: [red, green, blue]");
    }
  }
  int order = 0;
  r.choice("order", {"chance", "checker"}, order);
  c.checker = order == 1;
  r.pair("shade", c.shade, {0, 2, false, "a shade must be between 0 and 2"});
  read_colour(r, "joint", c.joint);
  read_colour(r, "rim", c.rim);
  r.number("rim_amount", c.rim_amount, share);
  r.number("rim_reach", c.rim_reach, some_length);
}

}  // namespace

void read_colour(TomlReader& r, const char* key, Vec3& colour) {
  r.vector(key, colour);
  if (colour.minCoeff() < 0 || colour.maxCoeff() > 1) {
    r.fail_at(key, fmt::format("{} is no colour", key), "sRGB in 0..1: [red, green, blue]");
  }
}

Result<BuiltinRecipe> parse_builtin(std::string_view text, const std::string& file_name) {
  const toml::parse_result parsed = toml::parse(text, file_name);
  if (!parsed) {
    const toml::parse_error& error = parsed.error();
    return fail(fmt::format("{}:{}", file_name, error.source().begin.line), std::string(error.description()),
                "see docs/materials.md");
  }
  std::optional<Error> error;
  BuiltinRecipe recipe;
  BuiltinMaterial& about = recipe.about;
  about.name = about.title = std::filesystem::path(file_name).stem().string();
  about.material = *find_material("brick");
  int seed = static_cast<int>(recipe.seed);
  TomlReader r(parsed.table(), file_name, "", error);
  r.text("title", about.title);
  r.table("study", [&](TomlReader& t) { read_study(t, about); });
  read_material(r, "material", about.material);
  r.number("depth", about.depth_fraction,
           {0, 0.5, false, "the full depth is a fraction of the side, 0 to 0.5"});
  r.number("roughness", about.roughness, share);
  r.whole("seed", seed, {0, 1e9, false, "a seed must be a whole number from 0 to 1e9"});
  r.table("layout", [&](TomlReader& t) { read_layout(t, recipe.layout); });
  r.table("profile", [&](TomlReader& t) { read_profile(t, recipe.profile); });
  r.tables("layer", [&](TomlReader& t) { read_layer(t, recipe.layout.pattern, recipe.layers); });
  r.table("colour", [&](TomlReader& t) { read_paint(t, recipe.colour); });
  r.finish();
  recipe.seed = static_cast<std::uint64_t>(seed);
  if (error) return tl::unexpected(*error);
  return recipe;
}

}  // namespace intaglio::surface
