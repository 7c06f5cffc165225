#include "intaglio/surface/mesh/relief_mesh.h"

#include <cmath>

#include "intaglio/surface/extent.h"
#include "intaglio/surface/mesh/base_patch.h"

namespace intaglio::surface {

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
  const Extent z = surface.is_flat() ? Extent{} : extent(surface, uv.min(), uv.max());
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
  const double deepest = surface->is_flat() ? 0 : surface->max_depth() * surface->pyramid().whole().deep;
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
