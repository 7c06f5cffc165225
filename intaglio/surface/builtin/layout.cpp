#include "intaglio/surface/builtin/layout.h"

#include <algorithm>

#include "intaglio/core/elementary.h"

namespace intaglio::surface {

namespace {

// No joints at all: one endless piece.
class Sheet : public Cells {
 public:
  Spot at(double u, double v) const override { return {0, 0, 1, Vec2(u, v), Vec2(endless, endless), 1}; }
};

std::unique_ptr<Cells> make_cells(const LayoutRecipe& recipe, std::uint64_t seed) {
  switch (recipe.pattern) {
    case Pattern::sheet:
      break;
    case Pattern::bond:
      return make_bond(recipe, seed);
    case Pattern::herringbone:
      return make_herringbone(recipe, seed);
    case Pattern::voronoi:
      return make_voronoi(recipe, seed);
    case Pattern::scatter:
      return make_scatter(recipe, seed);
    case Pattern::lugs:
      return make_lugs(recipe, seed);
    case Pattern::weave:
      return make_weave(recipe, seed);
  }
  return std::make_unique<Sheet>();
}

}  // namespace

double inside_box(const Vec2& local, const Vec2& half, const LayoutRecipe& recipe) {
  const double qx = std::abs(local.x()) - (half.x() - 0.5 * recipe.joint - recipe.corner);
  const double qy = std::abs(local.y()) - (half.y() - 0.5 * recipe.joint - recipe.corner);
  const double past_corner = elementary::hypot(std::max(qx, 0.0), std::max(qy, 0.0));
  return recipe.corner - past_corner - std::min(std::max(qx, qy), 0.0);
}

Layout::Layout(const LayoutRecipe& r, std::uint64_t seed) : cells_(make_cells(r, seed)) {
  if (r.warp > 0) {
    warp_ = Bend{r.warp,
                 {r.warp_frequency, r.warp_frequency, 3, 0.5, seed + 100},
                 {r.warp_frequency, r.warp_frequency, 3, 0.5, seed + 200}};
  }
  if (r.chip > 0) {
    chip_ = Bend{r.chip,
                 {r.chip_frequency, r.chip_frequency, 2, 0.6, seed + 300},
                 {r.chip_frequency, r.chip_frequency, 2, 0.6, seed + 400}};
  }
}

Spot Layout::at(double u, double v) const {
  double du = 0;
  double dv = 0;
  for (const auto* bend : {&warp_, &chip_}) {
    if (!*bend) continue;
    du += (*bend)->reach * (*bend)->u(u, v);
    dv += (*bend)->reach * (*bend)->v(u, v);
  }
  return cells_->at(u + du, v + dv);
}

}  // namespace intaglio::surface
