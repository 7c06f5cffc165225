// Depth and colour of a recipe at any point: what make_texture samples. Layers of detail on a layout of
// pieces.
//
// Everything repeats with period 1 in u and v. Immutable; any thread.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "intaglio/vec.h"
#include "surface/recipes/layout.h"
#include "surface/recipes/recipe.h"

namespace intaglio::surface {

// Where a detail is evaluated: at (u, v) of the tile, on the piece of `spot`. The detail follows x and y:
// those of the tile again, or the piece's own axes with a random offset.
struct DetailPoint {
  double u, v;
  double x, y;
  const PiecePoint& spot;
};

// A detail: a value at a point, in 0..1 (for noise and steps about 0), from which a layer derives depth and
// colour.
class DetailField {
 public:
  virtual ~DetailField() = default;
  virtual double at(const DetailPoint& place) const = 0;
};

// `seed` is the layer's own. Grain uses the layout to assign knots to pieces.
std::unique_ptr<DetailField> make_detail(const LayerRecipe& layer, const Layout& layout, std::uint64_t seed);

struct PaintedPoint {
  double depth = 0;            // 0..1, 0 = top
  Vec3 colour = Vec3::Zero();  // sRGB, 0..1
};

class Painter {
 public:
  explicit Painter(const Recipe& recipe);
  PaintedPoint at(double u, double v) const;

 private:
  // Accumulated layers on a piece or in a joint.
  struct LayerSum {
    double depth = 0;
    double shade = 1;
    Vec3 colour;
  };
  struct Layer {
    LayerRecipe recipe;
    std::unique_ptr<DetailField> detail;
  };

  double random_value(const PiecePoint& spot, std::uint64_t k) const;
  LayerSum sum_layers(AppliesTo on, double u, double v, const PiecePoint& spot, const Vec3& colour) const;
  PaintedPoint in_joint(double u, double v, const PiecePoint& spot) const;
  PaintedPoint on_face(double u, double v, const PiecePoint& spot) const;
  Vec3 piece_colour(const PiecePoint& spot) const;

  Recipe r_;
  Layout layout_;
  std::vector<Layer> layers_;
};

}  // namespace intaglio::surface
