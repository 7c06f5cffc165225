#include "mesh/relief_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mesh/base_patch.h"
#include "surface/surface.h"

namespace intaglio::surface {

PrismTree::PrismTree(std::span<const Box> boxes) : items_(boxes.size()) {
  std::iota(items_.begin(), items_.end(), 0);
  nodes_.reserve(2 * boxes.size());
  if (!boxes.empty()) build(boxes, 0, static_cast<int>(boxes.size()));
  nodes_.shrink_to_fit();
}

// Depth is the logarithm of the count, give or take one: median splits.
int PrismTree::build(std::span<const Box> boxes, int first, int count) {
  const int index = static_cast<int>(nodes_.size());
  Box box, middles;
  for (int k = first; k < first + count; ++k) {
    const Box& item = boxes[static_cast<std::size_t>(items_[static_cast<std::size_t>(k)])];
    box.extend(item);
    middles.extend(item.center());
  }
  nodes_.push_back({box, first, count});
  if (count <= per_leaf) return index;
  Eigen::Index axis = 0;
  middles.sizes().maxCoeff(&axis);
  const int half = count / 2;
  std::nth_element(items_.begin() + first, items_.begin() + first + half, items_.begin() + first + count,
                   [&](int a, int b) {
                     const double at_a = boxes[static_cast<std::size_t>(a)].center()[axis],
                                  at_b = boxes[static_cast<std::size_t>(b)].center()[axis];
                     return at_a < at_b || (at_a == at_b && a < b);
                   });
  build(boxes, first, half);
  const int second = build(boxes, first + half, count - half);
  nodes_[static_cast<std::size_t>(index)].next = second;
  nodes_[static_cast<std::size_t>(index)].count = 0;
  return index;
}

namespace {

BasePatch patch_of(const TriangleMesh& mesh, int triangle) {
  const auto [a, b, c] = mesh.triangles[static_cast<std::size_t>(triangle)];
  const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b),
             k = static_cast<std::size_t>(c);
  return {{mesh.positions[i], mesh.positions[j], mesh.positions[k]},
          {mesh.normals[i], mesh.normals[j], mesh.normals[k]}};
}

// What the relief over a triangle is within: p + z N is within its prism, and z n is z (1 - |N|) away.
Box prism(const Surface& surface, const TriangleMesh& mesh, int triangle, double least_normal) {
  Eigen::AlignedBox2d uv;
  for (const int k : mesh.triangles[static_cast<std::size_t>(triangle)])
    uv.extend(mesh.uvs[static_cast<std::size_t>(k)]);
  const HeightRange z = surface.is_flat() ? HeightRange{} : height_range(surface, uv.min(), uv.max());
  Box box;
  const BasePatch patch = patch_of(mesh, triangle);
  for (std::size_t k = 0; k < 3; ++k) {
    box.extend(Vec3(patch.p[k] + z.low * patch.n[k]));
    box.extend(Vec3(patch.p[k] + z.high * patch.n[k]));
  }
  const Vec3 play = Vec3::Constant(std::max(-z.low, 0.0) * (1 - least_normal) + 1e-12 * box.sizes().norm());
  return {box.min() - play, box.max() + play};
}

// Metres that a texel is long, the shorter side, by the areas and lengths of all triangles.
double texel_of(const MeshPlacement& base, const Surface& surface) {
  double area = 0, texels = 0;
  const TriangleMesh& mesh = base.mesh();
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b),
               k = static_cast<std::size_t>(c);
    area += (mesh.positions[j] - mesh.positions[i]).cross(mesh.positions[k] - mesh.positions[i]).norm();
    const Vec2 u = mesh.uvs[j] - mesh.uvs[i], v = mesh.uvs[k] - mesh.uvs[i];
    texels +=
        surface.is_flat() ? 1 : std::abs(u[0] * v[1] - u[1] * v[0]) * surface.width() * surface.height();
  }
  return std::sqrt(area / std::max(texels, 1e-300));
}

}  // namespace

Result<ReliefMesh> ReliefMesh::make(std::shared_ptr<const Surface> surface, MeshPlacement base) {
  if (!surface) return fail("relief mesh", "has no surface", "hand one in");
  const double deepest =
      surface->is_flat() ? 0 : surface->max_depth() * surface->pyramid().total_range().deep;
  if (const auto possible = base.check_depth(deepest); !possible && deepest > 0)
    return tl::unexpected(possible.error());
  const ReliefCells cells(*surface);
  const TriangleMesh& mesh = base.mesh();
  std::vector<Box> boxes;
  boxes.reserve(mesh.triangles.size());
  for (int k = 0; k < static_cast<int>(mesh.triangles.size()); ++k)
    boxes.push_back(prism(*surface, mesh, k, ReliefTriangle(mesh, cells.texels(), k).least_normal));
  const double texel = texel_of(base, *surface);
  TriangleFans fans(mesh);
  return ReliefMesh(std::make_shared<const Data>(
      Data{std::move(surface), std::move(base), cells, PrismTree(boxes), std::move(fans), texel}));
}

ReliefTriangle ReliefMesh::triangle(int k) const {
  return {data_->base.mesh(), data_->cells.texels(), k};
}

Vec3 ReliefMesh::point(int triangle, const Vec3& weights) const {
  const BasePoint base = data_->base.at(triangle, weights);
  return data_->base.to_world(triangle, weights, -data_->surface->depth(base.uv));
}

Eigen::Matrix<double, 2, 3> ReliefMesh::sweep(const BasePoint& under, const Quat& orientation) const {
  constexpr double least_area = 1e-4;  // of a triangle in the texture, relative to its sides squared
  const Eigen::Matrix2d stretch = base().stretch(under);
  if (std::abs(stretch.determinant()) < least_area * stretch.squaredNorm())
    return Eigen::Matrix<double, 2, 3>::Zero();
  Eigen::Matrix<double, 2, 3> along;
  along << (orientation * under.t).transpose(), (orientation * under.b).transpose();
  return surface().placement().size().asDiagonal() * stretch.inverse() * along;
}

BasePoint ReliefMesh::under(int triangle, const Vec2& weights) const {
  const Vec3 all(1 - weights[0] - weights[1], weights[0], weights[1]);
  BasePoint out = data_->base.at(triangle, all);
  out.height = -data_->surface->depth(out.uv);
  return out;
}

std::optional<BasePoint> ReliefMesh::under(int triangle, const Vec3& point) const {
  const double reach = 2 * data_->surface->max_depth() + 1e-9;
  const auto found = project(patch_of(data_->base.mesh(), triangle), point, reach);
  if (!found) return std::nullopt;
  return data_->base.at(triangle, found->weights, found->height);
}

}  // namespace intaglio::surface
