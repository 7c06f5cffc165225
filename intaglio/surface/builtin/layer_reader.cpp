#include <algorithm>

#include "intaglio/surface/builtin/recipe_reader.h"

namespace intaglio::surface {

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
