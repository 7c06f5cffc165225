#include "contact/leaf_walk.h"

#include <algorithm>
#include <cmath>

namespace intaglio::contact {

Leaf::Leaf(const surface::Surface& surface, int first_i, int first_j)
    : i(first_i),
      j(first_j),
      begin_c(std::max(0, -i)),
      end_c(std::min(side, surface.width() - i)),
      last_c(std::min(side, surface.width() - 1 - i)),
      begin_r(std::max(0, -j)),
      end_r(std::min(side, surface.height() - j)),
      last_r(std::min(side, surface.height() - 1 - j)),
      w(surface.texel_u()),
      h(surface.texel_v()) {
  for (int r = -1; r <= side; ++r) {
    for (int c = -1; c <= side; ++c) {
      const bool there = i + c >= 0 && i + c < surface.width() && j + r >= 0 && j + r < surface.height();
      z[std::size_t(r + 1)][std::size_t(c + 1)] = there ? surface.texel_z(i + c, j + r) : outside_z;
    }
  }
}

HeightRange range_over(const surface::Surface& surface, const Vec2& low, const Vec2& high) {
  using surface::Pyramid;
  const Pyramid& pyramid = surface.pyramid();
  // Cells, counted from the first; what is outside belongs to the nearest.
  const auto cell = [&](double at, double size, int cells) {
    return int(std::clamp(std::floor(at / size - 0.5) - pyramid.first_cell(), 0.0, cells - 1.0));
  };
  const double w = surface.texel_u(), h = surface.texel_v();
  const int i0 = cell(low.x(), w, pyramid.columns()), i1 = cell(high.x(), w, pyramid.columns()),
            j0 = cell(low.y(), h, pyramid.rows()), j1 = cell(high.y(), h, pyramid.rows());
  const double scale = -surface.max_depth();
  int level = 1;
  while (level < pyramid.levels() && Pyramid::block_cells(level) < std::max(i1 - i0, j1 - j0)) ++level;
  if (level >= pyramid.levels())
    return {scale * pyramid.total_range().deep, scale * pyramid.total_range().shallow};
  const int side = Pyramid::block_cells(level);
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
