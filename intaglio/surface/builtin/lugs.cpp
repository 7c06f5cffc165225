// The studs of tread plate: lenses in a lattice, turned by 45 degrees one way and the other in turn. As wide
// as they are long they are round.
#include <numbers>

#include "intaglio/core/elementary.h"
#include "intaglio/surface/builtin/layout.h"

namespace intaglio::surface {

namespace {

class Lugs : public Cells {
 public:
  explicit Lugs(const LayoutRecipe& recipe) : r_(recipe) {}

  Spot at(double u, double v) const override {
    const int i = static_cast<int>(std::floor(u * r_.columns));
    const int j = static_cast<int>(std::floor(v * r_.rows));
    const Vec2 d(u - (i + 0.5) / r_.columns, v - (j + 0.5) / r_.rows);
    const double turn = ((i + j) & 1) != 0 ? 1 : -1;
    const Vec2 local = Vec2(d.x() + turn * d.y(), d.y() - turn * d.x()) / std::numbers::sqrt2;
    return {
        wrapped(i, r_.columns), wrapped(j, r_.rows), inside(local), local, {r_.radius.y(), r_.radius.x()}, 1};
  }

 private:
  // Signed distance into the lens that two equal circles share.
  double inside(const Vec2& local) const {
    const double half_width = r_.radius.x();
    const double half_length = r_.radius.y();
    const double circle = (half_length * half_length + half_width * half_width) / (2 * half_width);
    const double offset = circle - half_width;
    const double x = std::abs(local.x());
    const double y = std::abs(local.y());
    const bool beyond_tip = (x - half_length) * offset > y * half_length;
    return beyond_tip ? -elementary::hypot(x - half_length, y) : circle - elementary::hypot(x, y + offset);
  }

  LayoutRecipe r_;
};

}  // namespace

std::unique_ptr<Cells> make_lugs(const LayoutRecipe& recipe, std::uint64_t) {
  return std::make_unique<Lugs>(recipe);
}

}  // namespace intaglio::surface
