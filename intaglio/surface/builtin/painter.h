// Depth and colour of a recipe at any point: what make_texture samples.
//
// Everything repeats with period 1 in u and v. Immutable; any thread.
#pragma once

#include <memory>
#include <vector>

#include "intaglio/core/vec.h"
#include "intaglio/surface/builtin/detail.h"
#include "intaglio/surface/builtin/layout.h"
#include "intaglio/surface/builtin/recipe.h"

namespace intaglio::surface {

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
