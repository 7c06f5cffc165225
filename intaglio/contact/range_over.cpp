#include "intaglio/contact/range_over.h"

#include <algorithm>
#include <cmath>

namespace intaglio::contact {

HeightRange range_over(const surface::Surface& surface, const Vec2& low, const Vec2& high) {
  using surface::Pyramid;
  const Pyramid& pyramid = surface.pyramid();
  const auto cell = [&](double at, double size, int cells) {
    return static_cast<int>(std::clamp(std::floor(at / size - 0.5) - pyramid.first(), 0.0, cells - 1.0));
  };
  const double w = surface.texel_u(), h = surface.texel_v();
  const int i0 = cell(low.x(), w, pyramid.columns()), i1 = cell(high.x(), w, pyramid.columns()),
            j0 = cell(low.y(), h, pyramid.rows()), j1 = cell(high.y(), h, pyramid.rows());
  const double scale = -surface.max_depth();
  int level = 1;
  while (level < pyramid.levels() && Pyramid::side(level) < std::max(i1 - i0, j1 - j0)) ++level;
  if (level >= pyramid.levels()) return {scale * pyramid.whole().deep, scale * pyramid.whole().shallow};
  const int side = Pyramid::side(level);
  Pyramid::Range all = pyramid.range(level, i0 / side, j0 / side);
  for (int y = j0 / side; y <= j1 / side; ++y) {
    for (int x = i0 / side; x <= i1 / side; ++x) {
      const Pyramid::Range range = pyramid.range(level, x, y);
      all = {std::min(all.shallow, range.shallow), std::max(all.deep, range.deep)};
    }
  }
  return {scale * all.deep, scale * all.shallow};
}

}  // namespace intaglio::contact
