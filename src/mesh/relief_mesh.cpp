#include "mesh/relief_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mesh/base_patch.h"
#include "surface/surface.h"

namespace intaglio::surface {

BoxTree::BoxTree(std::span<const Bounds> boxes) : items_(boxes.size()) {
  std::iota(items_.begin(), items_.end(), 0);
  nodes_.reserve(2 * boxes.size());
  if (!boxes.empty()) build(boxes, 0, int(boxes.size()));
  nodes_.shrink_to_fit();
}

// Depth is the logarithm of the count, plus or minus one: median splits.
int BoxTree::build(std::span<const Bounds> boxes, int first, int count) {
  const int index = int(nodes_.size());
  Bounds box, middles;
  for (int k = first; k < first + count; ++k) {
    const Bounds& item = boxes[std::size_t(items_[std::size_t(k)])];
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
                     const double at_a = boxes[std::size_t(a)].center()[axis],
                                  at_b = boxes[std::size_t(b)].center()[axis];
                     return at_a < at_b || (at_a == at_b && a < b);
                   });
  build(boxes, first, half);
  const int second = build(boxes, first + half, count - half);
  nodes_[std::size_t(index)].next = second;
  nodes_[std::size_t(index)].count = 0;
  return index;
}

namespace {

// Bounds of the relief over a triangle: p + z N is within its prism, and z n is z (1 - |N|) away from there.
Bounds prism_bounds(const Surface& surface, const TriangleMesh& mesh, int triangle, double min_length) {
  Eigen::AlignedBox2d uv;
  for (const int k : mesh.triangles[std::size_t(triangle)]) uv.extend(mesh.uvs[std::size_t(k)]);
  const HeightRange z = surface.is_flat() ? HeightRange{} : height_range(surface, uv.min(), uv.max());
  Bounds box;
  const BasePatch patch = patch_of(mesh, triangle);
  for (std::size_t k = 0; k < 3; ++k) {
    box.extend(Vec3(patch.p[k] + z.low * patch.n[k]));
    box.extend(Vec3(patch.p[k] + z.high * patch.n[k]));
  }
  const Vec3 margin = Vec3::Constant(std::max(-z.low, 0.0) * (1 - min_length) + 1e-12 * box.sizes().norm());
  return {box.min() - margin, box.max() + margin};
}

// The square root of the mean area of a texel on the mesh.
double texel_size_of(const MeshPlacement& base, const Surface& surface) {
  double area = 0, texels = 0;
  const TriangleMesh& mesh = base.mesh();
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto i = std::size_t(a), j = std::size_t(b), k = std::size_t(c);
    area += (mesh.positions[j] - mesh.positions[i]).cross(mesh.positions[k] - mesh.positions[i]).norm();
    const Vec2 u = mesh.uvs[j] - mesh.uvs[i], v = mesh.uvs[k] - mesh.uvs[i];
    texels +=
        surface.is_flat() ? 1 : std::abs(u[0] * v[1] - u[1] * v[0]) * surface.width() * surface.height();
  }
  return std::sqrt(area / std::max(texels, 1e-300));
}

}  // namespace

Result<ReliefMesh> ReliefMesh::make(std::shared_ptr<const Surface> surface, MeshPlacement base) {
  if (!surface) return fail("relief mesh", "has no surface", "pass one");
  const double max_depth =
      surface->is_flat() ? 0 : surface->max_depth() * surface->pyramid().total_range().deep;
  if (const auto possible = base.check_depth(max_depth); !possible && max_depth > 0)
    return tl::unexpected(possible.error());
  const CellGrid cells(*surface);
  const TriangleMesh& mesh = base.mesh();
  std::vector<Bounds> boxes;
  boxes.reserve(mesh.triangles.size());
  for (int k = 0; k < int(mesh.triangles.size()); ++k)
    boxes.push_back(prism_bounds(*surface, mesh, k, ReliefTriangle(mesh, cells.texels(), k).min_length));
  const double texel_size = texel_size_of(base, *surface);
  VertexTriangles vertex_triangles(mesh);
  return ReliefMesh(std::make_shared<const Data>(Data{
      std::move(surface), std::move(base), cells, BoxTree(boxes), std::move(vertex_triangles), texel_size}));
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

BasePoint ReliefMesh::base_below(int triangle, const Vec2& weights) const {
  BasePoint out = data_->base.at(triangle, barycentric(weights));
  out.height = -data_->surface->depth(out.uv);
  return out;
}

std::optional<BasePoint> ReliefMesh::base_below(int triangle, const Vec3& point) const {
  const double reach = 2 * data_->surface->max_depth() + 1e-9;
  const auto found = project(patch_of(data_->base.mesh(), triangle), point, reach);
  if (!found) return std::nullopt;
  return data_->base.at(triangle, found->weights, found->height);
}

}  // namespace intaglio::surface
