// The details that a recipe lays over its pieces: each a value at a point, in 0..1 (noise and steps aside,
// which swing about 0), from which a layer takes depth and colour.
#pragma once

#include <cstdint>
#include <memory>

#include "intaglio/surface/builtin/layout.h"
#include "intaglio/surface/builtin/recipe.h"

namespace intaglio::surface {

// Where a detail is asked: at (u, v) of the tile, in the piece of `spot`. It follows x and y: those of the
// tile again, or the piece's own axes from a start by chance.
struct Place {
  double u, v;
  double x, y;
  const Spot& spot;
};

class DetailField {
 public:
  virtual ~DetailField() = default;
  virtual double at(const Place& place) const = 0;
};

// `seed` is the layer's own. Grain asks the layout on which pieces its knots lie.
std::unique_ptr<DetailField> make_detail(const LayerRecipe& layer, const Layout& layout, std::uint64_t seed);

std::unique_ptr<DetailField> make_grain(const LayerRecipe& layer, const Layout& layout, std::uint64_t seed);
std::unique_ptr<DetailField> make_scratches(const LayerRecipe& layer, std::uint64_t seed);

}  // namespace intaglio::surface
