#include <algorithm>

#include "intaglio/surface/builtin/recipe_reader.h"

namespace intaglio::surface {

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

}  // namespace intaglio::surface
