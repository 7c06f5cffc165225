#include "intaglio/surface/mesh/relief_piece.h"

#include <algorithm>
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

}  // namespace intaglio::surface
