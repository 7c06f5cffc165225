#include "mesh/relief_piece.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace intaglio::surface {

ReliefTriangle::ReliefTriangle(const TriangleMesh& mesh, const Vec2& texels, int triangle) : index(triangle) {
  const Triangle& corners = mesh.triangles[static_cast<std::size_t>(triangle)];
  const auto a = static_cast<std::size_t>(corners[0]), b = static_cast<std::size_t>(corners[1]),
             c = static_cast<std::size_t>(corners[2]);
  p = mesh.positions[a];
  p_a = mesh.positions[b] - p;
  p_b = mesh.positions[c] - p;
  n = mesh.normals[a];
  n_a = mesh.normals[b] - n;
  n_b = mesh.normals[c] - n;
  // All N lie in the triangle of the three, which is as far from the origin as this plane at most.
  const Vec3 middle = 3 * n + n_a + n_b;
  const double towards = n.dot(middle);
  least_normal = std::max(
      1e-6, (towards + std::min({0.0, n_a.dot(middle), n_b.dot(middle)})) / std::max(1e-12, middle.norm()));
  bend_a = n_a.norm() / least_normal;
  bend_b = n_b.norm() / least_normal;
  x = mesh.uvs[a].cwiseProduct(texels) - Vec2::Constant(0.5);
  x_a = (mesh.uvs[b] - mesh.uvs[a]).cwiseProduct(texels);
  x_b = (mesh.uvs[c] - mesh.uvs[a]).cwiseProduct(texels);
}

FlatPiece::FlatPiece(const ReliefTriangle& triangle, const WeightPolygon& polygon, const Heights& heights,
                     const Vec2& middle_of_polygon)
    : at(middle_of_polygon), outline(polygon) {
  const Vec3 normal = triangle.n + at[0] * triangle.n_a + at[1] * triangle.n_b;
  const double inverse = 1 / normal.norm();
  const Vec3 n = inverse * normal;
  const auto turn = [&](const Vec3& by) { return Vec3(heights.z * inverse * (by - n.dot(by) * n)); };
  middle = triangle.p + at[0] * triangle.p_a + at[1] * triangle.p_b + heights.z * n;
  along_a = triangle.p_a + heights.slope.dot(triangle.x_a) * n + turn(triangle.n_a);
  along_b = triangle.p_b + heights.slope.dot(triangle.x_b) * n + turn(triangle.n_b);
  // n leaves its value in the middle by `bend` at most, and its tangent there by 1.5 bend^2; a height that
  // rises with it is the other product of second order.
  const double slope_a = heights.slope.dot(triangle.x_a), slope_b = heights.slope.dot(triangle.x_b);
  Vec2 most = Vec2::Zero();
  for (const Vec2& corner : polygon) most = most.cwiseMax((corner - at).cwiseAbs());
  const double rise = std::abs(slope_a) * most[0] + std::abs(slope_b) * most[1];
  const double bend = triangle.bend_a * most[0] + triangle.bend_b * most[1];
  play = heights.play + (rise + heights.play) * bend + 1.5 * std::abs(heights.z) * bend * bend;
}

double FlatPiece::radius() const {
  double most = 0;
  for (const Vec2& corner : outline)
    most = std::max(most, ((corner[0] - at[0]) * along_a + (corner[1] - at[1]) * along_b).squaredNorm());
  return std::sqrt(most) + play;
}

Vec2 FlatPiece::longer_way() const {
  double a = 0, b = 0;
  for (const Vec2& corner : outline) {
    a = std::max(a, std::abs(corner[0] - at[0]));
    b = std::max(b, std::abs(corner[1] - at[1]));
  }
  return a * along_a.norm() >= b * along_b.norm() ? Vec2(1, 0) : Vec2(0, 1);
}

Vec3 ReliefPiece::Jet::second_along(const Vec3& g) const {
  const double gn = g.dot(n), ga = g.dot(n_a), gb = g.dot(n_b);
  const double aa = -(2 * ga * length_a + gn * n_a.squaredNorm() * length) / length;
  const double bb = -(2 * gb * length_b + gn * n_b.squaredNorm() * length) / length;
  const double ab = -(ga * length_b + gb * length_a + gn * n_a.dot(n_b) * length) / length;
  return {h_aa * gn + 2 * h_a * ga + h * aa, h_ab * gn + h_a * gb + h_b * ga + h * ab,
          h_bb * gn + 2 * h_b * gb + h * bb};
}

ReliefPiece::Jet ReliefPiece::at(const Vec2& weights) const {
  const ReliefTriangle& t = triangle;
  Jet out;
  const Vec3 normal = t.n + weights[0] * t.n_a + weights[1] * t.n_b;
  out.length = normal.norm();
  out.n = normal / out.length;
  out.length_a = out.n.dot(t.n_a);
  out.length_b = out.n.dot(t.n_b);
  out.n_a = (t.n_a - out.length_a * out.n) / out.length;
  out.n_b = (t.n_b - out.length_b * out.n) / out.length;
  const Vec2 cell = t.cells(weights) - Vec2(static_cast<double>(i), static_cast<double>(j));
  const double h_s = z_s + cell[1] * twist, h_t = z_t + cell[0] * twist;
  out.h = z + cell[0] * z_s + cell[1] * h_t;
  out.h_a = h_s * t.x_a[0] + h_t * t.x_a[1];
  out.h_b = h_s * t.x_b[0] + h_t * t.x_b[1];
  out.h_aa = 2 * twist * t.x_a[0] * t.x_a[1];
  out.h_ab = twist * (t.x_a[0] * t.x_b[1] + t.x_a[1] * t.x_b[0]);
  out.h_bb = 2 * twist * t.x_b[0] * t.x_b[1];
  out.point = t.p + weights[0] * t.p_a + weights[1] * t.p_b + out.h * out.n;
  out.by_a = t.p_a + out.h_a * out.n + out.h * out.n_a;
  out.by_b = t.p_b + out.h_b * out.n + out.h * out.n_b;
  return out;
}

Vec3 ReliefPiece::point(const Vec2& weights) const {
  const Vec2 cell = triangle.cells(weights) - Vec2(static_cast<double>(i), static_cast<double>(j));
  const double h = z + cell[0] * z_s + cell[1] * (z_t + cell[0] * twist);
  return triangle.p + weights[0] * triangle.p_a + weights[1] * triangle.p_b + h * base_normal(weights);
}

Heights ReliefPiece::heights(const Vec2& middle) const {
  const Vec2 x = triangle.cells(middle);
  Vec2 most = Vec2::Zero();
  for (const Vec2& corner : outline) most = most.cwiseMax((triangle.cells(corner) - x).cwiseAbs());
  const Vec2 cell = x - Vec2(static_cast<double>(i), static_cast<double>(j));
  return {z + cell[0] * z_s + cell[1] * (z_t + cell[0] * twist),
          {z_s + cell[1] * twist, z_t + cell[0] * twist},
          std::abs(twist) * most[0] * most[1]};
}

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
  const std::int64_t first = pyramid.first_cell(), columns = pyramid.columns(), rows = pyramid.rows();
  const std::int64_t period_i = floor_of_ratio(range.i0 - first, columns),
                     period_j = floor_of_ratio(range.j0 - first, rows);
  const std::int64_t i0 = range.i0 - first - period_i * columns, i1 = range.i1 - first - period_i * columns,
                     j0 = range.j0 - first - period_j * rows, j1 = range.j1 - first - period_j * rows;
  const bool repeats = surface_.edge() == Edge::wrap || (period_i == 0 && period_j == 0);
  const auto bits = static_cast<std::uint64_t>((i0 ^ i1) | (j0 ^ j1)) / Pyramid::leaf_cells;
  const int level = std::bit_width(bits);
  if (!repeats || i1 >= columns || j1 >= rows || level >= pyramid.levels()) {
    const Pyramid::Range whole = pyramid.total_range();
    return {-0.5 * surface_.max_depth() * (whole.shallow + whole.deep), Vec2::Zero(),
            0.5 * surface_.max_depth() * (whole.deep - whole.shallow)};
  }
  const std::int64_t side = Pyramid::block_cells(level), block_i = i0 / side, block_j = j0 / side;
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
  const std::int64_t first = surface_.pyramid().first_cell();
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
