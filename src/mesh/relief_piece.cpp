#include "mesh/relief_piece.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace intaglio::surface {

ReliefTriangle::ReliefTriangle(const TriangleMesh& mesh, const Vec2& texels, int triangle) : index(triangle) {
  const Triangle& corners = mesh.triangles[std::size_t(triangle)];
  const auto a = std::size_t(corners[0]), b = std::size_t(corners[1]), c = std::size_t(corners[2]);
  p = mesh.positions[a];
  p_a = mesh.positions[b] - p;
  p_b = mesh.positions[c] - p;
  n = mesh.normals[a];
  n_a = mesh.normals[b] - n;
  n_b = mesh.normals[c] - n;
  // As min_normal_length in base_patch.cpp.
  const Vec3 sum = 3 * n + n_a + n_b;
  const double towards = n.dot(sum);
  min_length =
      std::max(1e-6, (towards + std::min({0.0, n_a.dot(sum), n_b.dot(sum)})) / std::max(1e-12, sum.norm()));
  normal_rate_a = n_a.norm() / min_length;
  normal_rate_b = n_b.norm() / min_length;
  cell = mesh.uvs[a].cwiseProduct(texels) - Vec2::Constant(0.5);
  cell_a = (mesh.uvs[b] - mesh.uvs[a]).cwiseProduct(texels);
  cell_b = (mesh.uvs[c] - mesh.uvs[a]).cwiseProduct(texels);
}

// The error: X = p + z n with z = z0 + r + e, where r is the linear rise and |e| <= heights.error; and
// n = n0 + D + o, where D is the linear part of its change. With bend = |da| max|n_a| + |db| max|n_b|,
// |n - n0| <= bend, and |o| <= 1.5 bend^2: half of what bounds the second derivative of n along a line,
// -(2 L' n' + L |n'|^2 n) / L with L = |N|, where |L'| / L and |n'| are at most bend. The linear piece is
// p + (z0 + r) n0 + z0 D, so it differs from X by
//   |z0 o + r (n - n0) + e n| <= 1.5 |z0| bend^2 + |r| bend + heights.error.
// (heights.error * bend on top is slack.)
LinearPiece::LinearPiece(const ReliefTriangle& triangle, const BarycentricPolygon& polygon,
                         const HeightBounds& heights, const Vec2& centroid)
    : at(centroid), outline(polygon) {
  const Vec3 normal = triangle.n + at[0] * triangle.n_a + at[1] * triangle.n_b;
  const double inverse = 1 / normal.norm();
  const Vec3 n = inverse * normal;
  const auto turn = [&](const Vec3& by) { return Vec3(heights.z * inverse * (by - n.dot(by) * n)); };
  middle = triangle.p + at[0] * triangle.p_a + at[1] * triangle.p_b + heights.z * n;
  const double slope_a = heights.slope.dot(triangle.cell_a), slope_b = heights.slope.dot(triangle.cell_b);
  along_a = triangle.p_a + slope_a * n + turn(triangle.n_a);
  along_b = triangle.p_b + slope_b * n + turn(triangle.n_b);
  Vec2 half = Vec2::Zero();
  for (const Vec2& corner : polygon) half = half.cwiseMax((corner - at).cwiseAbs());
  const double rise = std::abs(slope_a) * half[0] + std::abs(slope_b) * half[1];
  const double bend = triangle.normal_rate_a * half[0] + triangle.normal_rate_b * half[1];
  error = heights.error + (rise + heights.error) * bend + 1.5 * std::abs(heights.z) * bend * bend;
}

double LinearPiece::radius() const {
  double most = 0;
  for (const Vec2& corner : outline)
    most = std::max(most, ((corner[0] - at[0]) * along_a + (corner[1] - at[1]) * along_b).squaredNorm());
  return std::sqrt(most) + error;
}

Vec2 LinearPiece::longer_axis() const {
  double a = 0, b = 0;
  for (const Vec2& corner : outline) {
    a = std::max(a, std::abs(corner[0] - at[0]));
    b = std::max(b, std::abs(corner[1] - at[1]));
  }
  return a * along_a.norm() >= b * along_b.norm() ? Vec2(1, 0) : Vec2(0, 1);
}

// N is linear; with L = |N|: L_a = n . N_a, n_a = (N_a - L_a n) / L. Since n . n_a = 0, L_aa = n_a . N_a =
// L |n_a|^2, and so n_aa = -(2 L_a n_a + L |n_a|^2 n) / L; n_ab likewise. Then
//   X_ab = h_ab n + h_a n_b + h_b n_a + h n_ab,
// for p is linear, too.
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
  const Vec2 cell = t.cells(weights) - Vec2(double(i), double(j));
  const double h_s = z_s + cell[1] * twist, h_t = z_t + cell[0] * twist;
  out.h = z + cell[0] * z_s + cell[1] * h_t;
  out.h_a = h_s * t.cell_a[0] + h_t * t.cell_a[1];
  out.h_b = h_s * t.cell_b[0] + h_t * t.cell_b[1];
  out.h_aa = 2 * twist * t.cell_a[0] * t.cell_a[1];
  out.h_ab = twist * (t.cell_a[0] * t.cell_b[1] + t.cell_a[1] * t.cell_b[0]);
  out.h_bb = 2 * twist * t.cell_b[0] * t.cell_b[1];
  out.point = t.p + weights[0] * t.p_a + weights[1] * t.p_b + out.h * out.n;
  out.by_a = t.p_a + out.h_a * out.n + out.h * out.n_a;
  out.by_b = t.p_b + out.h_b * out.n + out.h * out.n_b;
  return out;
}

Vec3 ReliefPiece::point(const Vec2& weights) const {
  const Vec2 cell = triangle.cells(weights) - Vec2(double(i), double(j));
  const double h = z + cell[0] * z_s + cell[1] * (z_t + cell[0] * twist);
  return triangle.p + weights[0] * triangle.p_a + weights[1] * triangle.p_b + h * base_normal(weights);
}

HeightBounds ReliefPiece::heights(const Vec2& about) const {
  const Vec2 x = triangle.cells(about);
  Vec2 most = Vec2::Zero();
  for (const Vec2& corner : outline) most = most.cwiseMax((triangle.cells(corner) - x).cwiseAbs());
  const Vec2 cell = x - Vec2(double(i), double(j));
  return {z + cell[0] * z_s + cell[1] * (z_t + cell[0] * twist),
          {z_s + cell[1] * twist, z_t + cell[0] * twist},
          std::abs(twist) * most[0] * most[1]};
}

namespace {

std::int64_t floor_div(std::int64_t a, std::int64_t b) {
  return a >= 0 ? a / b : -((b - 1 - a) / b);
}

}  // namespace

CellGrid::CellGrid(const Surface& surface) : surface_(surface) {}

CellRange CellGrid::range(const ReliefTriangle& triangle, const BarycentricPolygon& outline) const {
  if (surface_.is_flat()) return {0, 0, 0, 0};
  Vec2 low = triangle.cells(outline[0]), high = low;
  for (const Vec2& corner : outline) {
    const Vec2 at = triangle.cells(corner);
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  // A part that ends on a line of the grid does not reach into the next cell.
  const auto last = [](double from, double to) { return std::max(std::floor(from), std::ceil(to) - 1); };
  return {std::int64_t(std::floor(low[0])), std::int64_t(last(low[0], high[0])),
          std::int64_t(std::floor(low[1])), std::int64_t(last(low[1], high[1]))};
}

HeightBounds CellGrid::heights(const CellRange& range, const Vec2& about) const {
  if (surface_.is_flat()) return {0, Vec2::Zero(), 0};
  const Pyramid& pyramid = surface_.pyramid();
  const std::int64_t first = pyramid.first_cell(), columns = pyramid.columns(), rows = pyramid.rows();
  const std::int64_t period_i = floor_div(range.i0 - first, columns),
                     period_j = floor_div(range.j0 - first, rows);
  const std::int64_t i0 = range.i0 - first - period_i * columns, i1 = range.i1 - first - period_i * columns,
                     j0 = range.j0 - first - period_j * rows, j1 = range.j1 - first - period_j * rows;
  const bool repeats = surface_.edge() == Edge::wrap || (period_i == 0 && period_j == 0);
  const auto bits = std::uint64_t((i0 ^ i1) | (j0 ^ j1)) / Pyramid::leaf_cells;
  const int level = std::bit_width(bits);
  if (!repeats || i1 >= columns || j1 >= rows || level >= pyramid.levels()) {
    const Pyramid::Range whole = pyramid.total_range();
    return {-0.5 * surface_.max_depth() * (whole.shallow + whole.deep), Vec2::Zero(),
            0.5 * surface_.max_depth() * (whole.deep - whole.shallow)};
  }
  const std::int64_t side = Pyramid::block_cells(level), block_i = i0 / side, block_j = j0 / side;
  const Pyramid::Slab slab = pyramid.slab(level, int(block_i), int(block_j));
  const auto middle = [&](std::int64_t block, std::int64_t period, std::int64_t cells) {
    return double(first + period * cells) + (double(block) + 0.5) * double(side);
  };
  const Vec2 from_middle = about - Vec2(middle(block_i, period_i, columns), middle(block_j, period_j, rows));
  const double scale = -surface_.max_depth();
  const Vec2 slope = scale * Vec2(slab.slope_x, slab.slope_y);
  return {0.5 * scale * (slab.low + slab.high) + slope.dot(from_middle), slope,
          -0.5 * scale * (slab.high - slab.low)};
}

std::int64_t CellGrid::split_between(std::int64_t from, std::int64_t to, std::int64_t cells) const {
  const std::int64_t first = surface_.pyramid().first_cell();
  const std::int64_t period = floor_div(from - first, cells), last = floor_div(to - first, cells);
  if (period < last) return first + floor_div(period + last + 1, 2) * cells;
  const std::int64_t a = from - first - period * cells, b = to - first - period * cells;
  // The highest bit in which a and b differ: the boundary of the largest pyramid block between them.
  const int width = std::bit_width(std::uint64_t(a ^ b)) - 1;
  return first + period * cells + ((b >> width) << width);
}

CellGrid::Split CellGrid::split(const CellRange& range) const {
  const Pyramid& pyramid = surface_.pyramid();
  if (range.i1 - range.i0 >= range.j1 - range.j0)
    return {0, split_between(range.i0, range.i1, pyramid.columns())};
  return {1, split_between(range.j0, range.j1, pyramid.rows())};
}

ReliefPiece CellGrid::piece(const ReliefTriangle& triangle, const BarycentricPolygon& outline,
                            const CellRange& one) const {
  if (surface_.is_flat()) return {triangle, one.i0, one.j0, 0, 0, 0, 0, outline};
  const Grid& grid = surface_.grid();
  const auto within = [&](std::int64_t at, int cells) {
    if (grid.edge == Edge::clamp) return int(std::clamp<std::int64_t>(at, -1, cells));
    return int(at - floor_div(at, cells) * cells);
  };
  const int i = within(one.i0, grid.width), j = within(one.j0, grid.height);
  const double z0 = surface_.texel_z(i, j), z1 = surface_.texel_z(i + 1, j), z2 = surface_.texel_z(i, j + 1),
               z3 = surface_.texel_z(i + 1, j + 1);
  return {triangle, one.i0, one.j0, z0, z1 - z0, z2 - z0, z3 - z2 - z1 + z0, outline};
}

}  // namespace intaglio::surface
