#include "intaglio/surface/mesh/relief_cells.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace intaglio::surface {

namespace {

std::int64_t floor_of_ratio(std::int64_t a, std::int64_t b) {
  return a >= 0 ? a / b : -((b - 1 - a) / b);
}

}  // namespace

ReliefCells::ReliefCells(const Surface& surface) : surface_(surface) {}

CellRange ReliefCells::range(const ReliefTriangle& triangle, const WeightPolygon& outline) const {
  if (surface_.is_flat()) return {0, 0, 0, 0};
  Vec2 low = triangle.cells(outline[0]), high = low;
  for (const Vec2& corner : outline) {
    const Vec2 at = triangle.cells(corner);
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  // What ends on a line of the grid does not reach into the next cell.
  const auto last = [](double from, double to) { return std::max(std::floor(from), std::ceil(to) - 1); };
  return {static_cast<std::int64_t>(std::floor(low[0])), static_cast<std::int64_t>(last(low[0], high[0])),
          static_cast<std::int64_t>(std::floor(low[1])), static_cast<std::int64_t>(last(low[1], high[1]))};
}

Heights ReliefCells::heights(const CellRange& range, const Vec2& about) const {
  if (surface_.is_flat()) return {0, Vec2::Zero(), 0};
  const Pyramid& pyramid = surface_.pyramid();
  const std::int64_t first = pyramid.first(), columns = pyramid.columns(), rows = pyramid.rows();
  const std::int64_t period_i = floor_of_ratio(range.i0 - first, columns),
                     period_j = floor_of_ratio(range.j0 - first, rows);
  const std::int64_t i0 = range.i0 - first - period_i * columns, i1 = range.i1 - first - period_i * columns,
                     j0 = range.j0 - first - period_j * rows, j1 = range.j1 - first - period_j * rows;
  const bool repeats = surface_.edge() == Edge::wrap || (period_i == 0 && period_j == 0);
  const auto bits = static_cast<std::uint64_t>((i0 ^ i1) | (j0 ^ j1)) / Pyramid::leaf;
  const int level = std::bit_width(bits);
  if (!repeats || i1 >= columns || j1 >= rows || level >= pyramid.levels()) {
    const Pyramid::Range whole = pyramid.whole();
    return {-0.5 * surface_.max_depth() * (whole.shallow + whole.deep), Vec2::Zero(),
            0.5 * surface_.max_depth() * (whole.deep - whole.shallow)};
  }
  const std::int64_t side = Pyramid::side(level), block_i = i0 / side, block_j = j0 / side;
  const Pyramid::Slab slab = pyramid.slab(level, static_cast<int>(block_i), static_cast<int>(block_j));
  const auto middle = [&](std::int64_t block, std::int64_t period, std::int64_t cells) {
    return static_cast<double>(first + period * cells) +
           (static_cast<double>(block) + 0.5) * static_cast<double>(side);
  };
  const Vec2 from_middle = about - Vec2(middle(block_i, period_i, columns), middle(block_j, period_j, rows));
  const double scale = -surface_.max_depth();
  const Vec2 slope = scale * Vec2(slab.slope_x, slab.slope_y);
  return {0.5 * scale * (slab.low + slab.high) + slope.dot(from_middle), slope,
          -0.5 * scale * (slab.high - slab.low)};
}

std::int64_t ReliefCells::cut_between(std::int64_t from, std::int64_t to, std::int64_t cells) const {
  const std::int64_t first = surface_.pyramid().first();
  const std::int64_t period = floor_of_ratio(from - first, cells), last = floor_of_ratio(to - first, cells);
  if (period < last) return first + floor_of_ratio(period + last + 1, 2) * cells;
  const std::int64_t a = from - first - period * cells, b = to - first - period * cells;
  // The last of b's leading bits that a does not share.
  const int width = std::bit_width(static_cast<std::uint64_t>(a ^ b)) - 1;
  return first + period * cells + ((b >> width) << width);
}

ReliefCells::Cut ReliefCells::cut(const CellRange& range) const {
  const Pyramid& pyramid = surface_.pyramid();
  if (range.i1 - range.i0 >= range.j1 - range.j0)
    return {0, cut_between(range.i0, range.i1, pyramid.columns())};
  return {1, cut_between(range.j0, range.j1, pyramid.rows())};
}

void ReliefCells::load(const CellRange& one, ReliefPiece& piece) const {
  piece.i = one.i0;
  piece.j = one.j0;
  piece.z = piece.z_s = piece.z_t = piece.twist = 0;
  if (surface_.is_flat()) return;
  const Grid& grid = surface_.grid();
  const auto within = [&](std::int64_t at, int cells) {
    if (grid.edge == Edge::clamp) return static_cast<int>(std::clamp<std::int64_t>(at, -1, cells));
    return static_cast<int>(at - floor_of_ratio(at, cells) * cells);
  };
  const int i = within(one.i0, grid.width), j = within(one.j0, grid.height);
  const double z0 = surface_.texel_z(i, j), z1 = surface_.texel_z(i + 1, j), z2 = surface_.texel_z(i, j + 1),
               z3 = surface_.texel_z(i + 1, j + 1);
  piece.z = z0;
  piece.z_s = z1 - z0;
  piece.z_t = z2 - z0;
  piece.twist = z3 - z2 - z1 + z0;
}

}  // namespace intaglio::surface
