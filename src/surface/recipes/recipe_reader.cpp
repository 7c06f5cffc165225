#include "surface/recipes/recipe_reader.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

#include "core/toml.h"
#include "surface/recipes/builtin.h"

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

namespace {

// How many repeats a pattern needs for every other one to differ and the tile still to repeat.
void need_even(TomlReader& r, const char* key, int value, const char* why) {
  if (value % 2 != 0) r.fail_at(key, fmt::format("{} is {}", key, value), why);
}

void read_bond(TomlReader& r, LayoutRecipe& l) {
  r.whole("columns", l.columns, {0, 256, false, "columns must be between 0 (endless strips) and 256"});
  r.whole("rows", l.rows, lattice);
  r.number("joint", l.joint, small_length);
  r.number("corner", l.corner, small_length);
  r.number("shift", l.shift, signed_share);
  r.number("stagger", l.stagger, share);
  r.pair("uneven", l.uneven, {0, 0.9, false, "it must be between 0 and 0.9"});
  r.number("split", l.split, share);
  if (l.shift != 0) need_even(r, "rows", l.rows, "rows must be even where every other one is shifted");
}

void read_herringbone(TomlReader& r, LayoutRecipe& l) {
  r.whole("columns", l.columns, lattice);
  r.whole("length", l.length, {1, 32, false, "a piece must be 1 to 32 times as long as wide"});
  r.number("joint", l.joint, small_length);
  r.number("corner", l.corner, small_length);
  if (l.columns % (2 * l.length) != 0) {
    r.fail_at("columns", fmt::format("columns is {}", l.columns),
              fmt::format("a herringbone of length {} repeats after {} columns", l.length, 2 * l.length));
  }
}

void read_voronoi(TomlReader& r, LayoutRecipe& l) {
  r.whole("columns", l.columns, {3, 256, false, "it must be a whole number between 3 and 256"});
  r.whole("rows", l.rows, {3, 256, false, "it must be a whole number between 3 and 256"});
  r.number("joint", l.joint, small_length);
  r.number("corner", l.corner, small_length);
  r.number("shift", l.shift, signed_share);
  r.number("jitter", l.jitter, share);
  if (l.shift != 0) need_even(r, "rows", l.rows, "rows must be even where every other one is shifted");
}

void read_radius(TomlReader& r, LayoutRecipe& l) {
  r.pair("radius", l.radius,
         {0.003, 0.25, false, "a radius is a fraction of the tile's side, 0.003 to 0.25"});
  if (l.radius.x() > l.radius.y())
    r.fail_at("radius", "radius is not in order", "the smaller first: [0.01, 0.05]");
}

void read_scatter(TomlReader& r, LayoutRecipe& l) {
  r.whole("stones", l.stones, {1, 5000, false, "a scatter has 1 to 5000 stones"});
  read_radius(r, l);
}

void read_lugs(TomlReader& r, LayoutRecipe& l) {
  r.whole("columns", l.columns, {2, 256, false, "it must be a whole number between 2 and 256"});
  r.whole("rows", l.rows, {2, 256, false, "it must be a whole number between 2 and 256"});
  read_radius(r, l);
  const double room = 0.7 / std::max(l.columns, l.rows);  // in its cell, turned by 45 degrees
  if (l.radius.y() > room) {
    r.fail_at("radius", "studs reach beyond their cells",
              fmt::format("here a radius may be at most {:.3f}", room));
  }
  need_even(r, "columns", l.columns, "columns must be even: studs turn one way and the other");
  need_even(r, "rows", l.rows, "rows must be even: studs turn one way and the other");
}

void read_weave(TomlReader& r, LayoutRecipe& l) {
  r.whole("columns", l.columns, {2, 256, false, "it must be a whole number between 2 and 256"});
  r.whole("rows", l.rows, {2, 256, false, "it must be a whole number between 2 and 256"});
  r.number("wire", l.wire, {0.1, 1, false, "a wire is 0.1 to 1 of the wires' spacing"});
  need_even(r, "columns", l.columns, "columns must be even: wires go over and under");
  need_even(r, "rows", l.rows, "rows must be even: wires go over and under");
}

}  // namespace

void read_layout(TomlReader& r, LayoutRecipe& l) {
  int pattern = 0;
  r.choice("pattern", {"sheet", "bond", "herringbone", "voronoi", "scatter", "lugs", "weave"}, pattern);
  l.pattern = static_cast<Pattern>(pattern);
  r.number("warp", l.warp, small_length);
  r.whole("warp_frequency", l.warp_frequency, {1, 64, false, "it must be a whole number between 1 and 64"});
  r.number("chip", l.chip, small_length);
  r.whole("chip_frequency", l.chip_frequency, {1, 128, false, "it must be a whole number between 1 and 128"});
  switch (l.pattern) {
    case Pattern::sheet:
      break;
    case Pattern::bond:
      return read_bond(r, l);
    case Pattern::herringbone:
      return read_herringbone(r, l);
    case Pattern::voronoi:
      return read_voronoi(r, l);
    case Pattern::scatter:
      return read_scatter(r, l);
    case Pattern::lugs:
      return read_lugs(r, l);
    case Pattern::weave:
      return read_weave(r, l);
  }
}

namespace {

constexpr Range factor{-4, 4, false, "it must be between -4 and 4"};
constexpr Range stream_range{0, 1000000, false, "a stream must be a whole number from 0 to 1000000"};

// The lattice of a layer's noise; its finest octave may have 512 cells a side.
void read_noise(TomlReader& r, LayerRecipe& l) {
  Vec2 frequency(l.frequency_u, l.frequency_v);
  r.pair("frequency", frequency, lattice);
  l.frequency_u = static_cast<int>(frequency.x());
  l.frequency_v = static_cast<int>(frequency.y());
  r.whole("octaves", l.octaves, {1, 9, false, "between 1 and 9 octaves"});
  r.number("gain", l.gain, share);
  if (frequency != Vec2(l.frequency_u, l.frequency_v)) {
    r.fail_at("frequency", "frequency is not whole", "two whole numbers of cells a side: [u, v]");
  } else if ((std::max(l.frequency_u, l.frequency_v) << (l.octaves - 1)) > 512) {
    r.fail_at("frequency", "the finest octave has more than 512 cells a side",
              "a lower frequency or fewer octaves");
  }
}

void read_scratches(TomlReader& r, LayerRecipe& l) {
  l.width = 0.002;
  r.whole("count", l.count, {1, 5000, false, "between 1 and 5000 scratches"});
  r.number("length", l.length, {0.001, 0.9, false, "a scratch is 0.001 to 0.9 of the tile's side long"});
  r.number("width", l.width, {0.0005, 0.01, false, "a scratch is 0.0005 to 0.01 of the tile's side wide"});
  r.number("direction", l.direction, {-180, 180, false, "a direction must be between -180 and 180 degrees"});
  r.number("spread", l.spread, {0, 180, false, "a spread must be between 0 and 180 degrees"});
}

void read_grain(TomlReader& r, LayerRecipe& l) {
  read_noise(r, l);
  r.whole("count", l.count, {1, 256, false, "between 1 and 256 rings a side"});
  r.number("bend", l.bend, {0, 32, false, "a bend must be between 0 and 32 rings"});
  r.whole("knots", l.knots, {0, 64, false, "between 0 and 64 knots"});
  r.number("knot", l.knot, {0.002, 0.06, false, "a knot's radius is 0.002 to 0.06 of the tile's side"});
}

void read_detail(TomlReader& r, LayerRecipe& l) {
  switch (l.detail) {
    case Detail::noise:
      return read_noise(r, l);
    case Detail::pits:
      r.number("threshold", l.threshold, signed_share);
      return read_noise(r, l);
    case Detail::veins:
      r.number("width", l.width, {0.005, 1, false, "a vein's width in noise must be between 0.005 and 1"});
      return read_noise(r, l);
    case Detail::steps:
      l.count = 5;
      r.whole("count", l.count, {1, 32, false, "between 1 and 32 steps"});
      r.number("threshold", l.threshold,
               {0, 0.98, false, "the flat share of a step must be between 0 and 0.98"});
      return read_noise(r, l);
    case Detail::grain:
      return read_grain(r, l);
    case Detail::scratches:
      return read_scratches(r, l);
    case Detail::rivets:
      l.count = 5;
      l.width = 0.02;
      r.whole("count", l.count, {2, 64, false, "between 2 and 64 rivets a side"});
      r.number("width", l.width, some_length);
      return r.number("inset", l.inset, small_length);
    case Detail::rosette:
      l.count = 8;
      l.width = 0.006;
      r.whole("count", l.count, {2, 32, false, "between 2 and 32 petals"});
      return r.number("width", l.width, some_length);
  }
}

}  // namespace

void read_layer(TomlReader& r, Pattern pattern, std::vector<LayerRecipe>& layers) {
  LayerRecipe l;
  l.stream = 1000 + 100 * static_cast<int>(layers.size());
  int detail = 0, on = 0, along = 0;
  r.choice("detail", {"noise", "pits", "veins", "steps", "grain", "scratches", "rivets", "rosette"}, detail);
  r.choice("on", {"pieces", "joints", "both"}, on);
  r.choice("along", {"tile", "piece"}, along);
  l.detail = static_cast<Detail>(detail);
  l.on = static_cast<On>(on);
  l.along = static_cast<Along>(along);
  if (l.detail == Detail::grain && l.along == Along::piece && pattern == Pattern::sheet) {
    r.fail_at("along", "rings along a piece where there are no pieces",
              "a sheet's grain needs along = \"tile\"");
  }
  r.whole("stream", l.stream, stream_range);
  r.number("depth", l.depth, factor);
  r.number("shade", l.shade, factor);
  read_colour(r, "paint", l.paint);
  r.number("paint_amount", l.paint_amount, {0, 10, false, "it must be between 0 and 10"});
  read_detail(r, l);
  layers.push_back(l);
}

}  // namespace intaglio::surface
