#include "intaglio/surface/mesh/tangent_frame.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "intaglio/core/elementary.h"

namespace intaglio::surface {

namespace {

// Numbers the vertices so that those of equal position, normal and UV have the same number.
std::vector<std::size_t> weld(const TriangleMesh& mesh) {
  std::vector<std::size_t> order(mesh.positions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto key = [&](std::size_t k) {
    const Vec3& p = mesh.positions[k];
    const Vec3& n = mesh.normals[k];
    const Vec2& uv = mesh.uvs[k];
    return std::make_tuple(p.x(), p.y(), p.z(), n.x(), n.y(), n.z(), uv.x(), uv.y());
  };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  std::vector<std::size_t> number(order.size());
  for (std::size_t k = 1; k < order.size(); ++k)
    number[order[k]] = number[order[k - 1]] + (key(order[k]) == key(order[k - 1]) ? 0 : 1);
  return number;
}

Vec3 laid_into_plane(const Vec3& n, const Vec3& direction) {
  const Vec3 flat = direction - n.dot(direction) * n;
  const double length = flat.norm();
  return length > 1e-9 * direction.norm() ? Vec3(flat / length) : Vec3(Vec3::Zero());
}

double corner_angle(const TriangleMesh& mesh, const Triangle& triangle, std::size_t corner, const Vec3& n) {
  const auto position = [&](std::size_t k) {
    return mesh.positions[static_cast<std::size_t>(triangle[k % 3])];
  };
  const Vec3 a = laid_into_plane(n, position(corner + 1) - position(corner));
  const Vec3 b = laid_into_plane(n, position(corner + 2) - position(corner));
  return elementary::acos(std::clamp(a.dot(b), -1.0, 1.0));
}

}  // namespace

UvDerivatives uv_derivatives(const TriangleMesh& mesh, std::size_t triangle) {
  const Triangle& corners = mesh.triangles[triangle];
  const auto a = static_cast<std::size_t>(corners[0]);
  const auto b = static_cast<std::size_t>(corners[1]);
  const auto c = static_cast<std::size_t>(corners[2]);
  const Vec2 uv1 = mesh.uvs[b] - mesh.uvs[a];
  const Vec2 uv2 = mesh.uvs[c] - mesh.uvs[a];
  const double determinant = uv1.x() * uv2.y() - uv1.y() * uv2.x();
  const double scale = std::max(uv1.squaredNorm(), uv2.squaredNorm());
  if (!(std::abs(determinant) > 1e-12 * scale) || scale < 1e-24) return {Vec3::Zero(), Vec3::Zero(), 1};
  const Vec3 e1 = mesh.positions[b] - mesh.positions[a];
  const Vec3 e2 = mesh.positions[c] - mesh.positions[a];
  return {(uv2.y() * e1 - uv1.y() * e2) / determinant, (uv1.x() * e2 - uv2.x() * e1) / determinant,
          determinant > 0 ? 1.0 : -1.0};
}

TangentFrame frame_along(const Vec3& n, const Vec3& tangent, double handedness) {
  Vec3 t = laid_into_plane(n, tangent);
  if (t.isZero()) t = n.unitOrthogonal();
  // Once more: what the first pass leaves along n grows where the tangent was nearly parallel to it.
  t = (t - n.dot(t) * n).normalized();
  return {t, handedness * n.cross(t), n};
}

CornerTangents corner_tangents(const TriangleMesh& mesh) {
  const std::vector<std::size_t> vertex = weld(mesh);
  std::array<std::vector<Vec3>, 2> sum;  // of the triangles that are mirrored, and of those that are not
  sum.fill(std::vector<Vec3>(mesh.positions.size(), Vec3::Zero()));
  CornerTangents tangents;
  tangents.t.resize(mesh.triangles.size());
  tangents.handedness.resize(mesh.triangles.size());
  const auto each_corner = [&](auto&& visit) {
    for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const auto index = static_cast<std::size_t>(mesh.triangles[k][corner]);
        visit(k, corner, mesh.normals[index], sum[tangents.handedness[k] > 0 ? 1 : 0][vertex[index]]);
      }
    }
  };
  std::vector<Vec3> along_u(mesh.triangles.size());
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const UvDerivatives derivatives = uv_derivatives(mesh, k);
    along_u[k] = derivatives.by_u;
    tangents.handedness[k] = static_cast<std::int8_t>(derivatives.handedness);
  }
  each_corner([&](std::size_t k, std::size_t corner, const Vec3& n, Vec3& total) {
    total += corner_angle(mesh, mesh.triangles[k], corner, n) * laid_into_plane(n, along_u[k]);
  });
  each_corner([&](std::size_t k, std::size_t corner, const Vec3& n, const Vec3& total) {
    tangents.t[k][corner] = frame_along(n, total, tangents.handedness[k]).t;
  });
  return tangents;
}

}  // namespace intaglio::surface
