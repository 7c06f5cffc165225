// The details that a recipe lays over its pieces: each a value at a point, in 0..1 (noise and steps aside,
// which swing about 0), from which a layer takes depth and colour.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "intaglio/vec.h"
#include "surface/recipes/layout.h"
#include "surface/recipes/recipe.h"

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

// Depth and colour of a recipe at any point: what make_texture samples.
//
// Everything repeats with period 1 in u and v. Immutable; any thread.

struct Sample {
  double depth = 0;            // 0..1, 0 = top
  Vec3 colour = Vec3::Zero();  // sRGB, 0..1
};

class Painter {
 public:
  explicit Painter(const BuiltinRecipe& recipe);
  Sample at(double u, double v) const;

 private:
  // What layers add up to on a piece or in a joint.
  struct Coat {
    double depth = 0;
    double shade = 1;
    Vec3 colour;
  };
  struct Layer {
    LayerRecipe recipe;
    std::unique_ptr<DetailField> detail;
  };

  double chance(const Spot& spot, std::uint64_t k) const;
  Coat coat(On on, double u, double v, const Spot& spot, const Vec3& colour) const;
  Sample in_joint(double u, double v, const Spot& spot) const;
  Sample on_face(double u, double v, const Spot& spot) const;
  Vec3 piece_colour(const Spot& spot) const;

  BuiltinRecipe r_;
  Layout layout_;
  std::vector<Layer> layers_;
};

}  // namespace intaglio::surface
