// Woven wire: round wires that go over and under each other in turn.
#include <algorithm>
#include <numbers>

#include "intaglio/core/elementary.h"
#include "intaglio/surface/builtin/layout.h"

namespace intaglio::surface {

namespace {

class Weave : public Cells {
 public:
  explicit Weave(const LayoutRecipe& recipe)
      : r_(recipe), radius_(0.5 * recipe.wire / std::max(recipe.columns, recipe.rows)) {}

  Spot at(double u, double v) const override {
    const Spot standing = wire(u * r_.columns, v * r_.rows, r_.columns, v, 0);
    const Spot lying = wire(v * r_.rows, u * r_.columns, r_.rows, u, 1);
    if (standing.inside <= 0 || lying.inside <= 0) return standing.inside > lying.inside ? standing : lying;
    return standing.rise > lying.rise ? standing : lying;
  }

 private:
  // The wire of a family nearest to a point: `across` and `along` count wires of this family and of the
  // other.
  Spot wire(double across, double along, int wires, double along_side, int family) const {
    const int k = static_cast<int>(std::floor(across));
    const double off = (across - k - 0.5) / wires;
    const double inside = radius_ - std::abs(off);
    const double over = ((k + family) & 1) != 0 ? -1 : 1;
    // From -1 to 2 radii: the middle swings by one radius, the round wire stands one above.
    const double swing = over * elementary::cos(std::numbers::pi * (along - 0.5));
    const double height = swing + std::sqrt(std::max(0.0, 1 - off * off / (radius_ * radius_)));
    return {wrapped(k, wires),      family,          inside, Vec2(along_side, off),
            Vec2(endless, radius_), (height + 1) / 3};
  }

  LayoutRecipe r_;
  double radius_;
};

}  // namespace

std::unique_ptr<Cells> make_weave(const LayoutRecipe& recipe, std::uint64_t) {
  return std::make_unique<Weave>(recipe);
}

}  // namespace intaglio::surface
