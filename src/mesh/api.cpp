#include "mesh/api.h"

#include <cmath>
#include <limits>

#include "mesh/mesh_file.h"
#include "mesh/relief_closest.h"

namespace intaglio {

Result<TriangleMesh> load_mesh(const std::filesystem::path& path, MeshUse use, std::uint64_t allowed_memory) {
  return surface::read_mesh(
      path, {use == MeshUse::texture ? surface::MeshUse::texture : surface::MeshUse::shape, allowed_memory});
}

TriangleMesh quad_mesh(const Vec2& size) {
  return surface::make_quad(surface::Placement(Vec3::Zero(), Quat::Identity(), size.x(), size.y()));
}
TriangleMesh sphere_mesh(double radius, int around, int up) {
  return surface::make_sphere(radius, around, up);
}
TriangleMesh cylinder_mesh(double radius, double height, int around, int up) {
  return surface::make_cylinder(radius, height, around, up);
}
TriangleMesh bowl_mesh(double radius, int around, int up) {
  return surface::make_bowl(radius, around, up);
}

TriangleMesh moved(TriangleMesh mesh, const Pose& pose) {
  return surface::moved(std::move(mesh), pose);
}
TriangleMesh repeated(TriangleMesh mesh, const Vec2& times) {
  for (Vec2& uv : mesh.uvs) uv = uv.cwiseProduct(times);
  return mesh;
}

Result<CurvedSurface> CurvedSurface::load(const std::filesystem::path& texture, TriangleMesh mesh,
                                          const SurfaceOptions& options) {
  auto base = surface::MeshPlacement::make(std::move(mesh));
  if (!base) return tl::unexpected(base.error());
  SurfaceOptions flat = options;
  flat.size = surface::texture_size(base->mesh());
  flat.pose = {};
  auto measured = Surface::load(texture, flat);
  if (!measured) return tl::unexpected(measured.error());
  auto relief = surface::ReliefMesh::make(measured->impl().surface, std::move(*base));
  if (!relief) return tl::unexpected(relief.error());
  return CurvedSurface(std::make_shared<const Impl>(Impl{std::move(*measured), std::move(*relief)}));
}

const Surface& CurvedSurface::surface() const {
  return impl_->surface;
}
const TriangleMesh& CurvedSurface::mesh() const {
  return impl_->relief.base().mesh();
}
Vec3 CurvedSurface::low() const {
  return impl_->relief.bounds().min();
}
Vec3 CurvedSurface::high() const {
  return impl_->relief.bounds().max();
}
double CurvedSurface::fold_depth() const {
  return impl_->relief.base().fold_depth();
}

std::optional<Vec3> CurvedSurface::point(const Vec2& uv) const {
  return impl_->relief.base().to_world(uv, impl_->surface.height(uv));
}

std::optional<ClosestPoint> CurvedSurface::closest(const Vec3& point, double reach) const {
  const auto found = surface::closest_point(impl_->relief, point, reach);
  if (!found) return std::nullopt;
  return ClosestPoint{found->distance, found->point, found->direction,
                      impl_->relief.base_below(found->triangle, found->weights).uv};
}

namespace surface {

Vec2 texture_size(const TriangleMesh& mesh) {
  Vec2 sum = Vec2::Zero();
  double total_area = 0;
  for (const Triangle& t : mesh.triangles) {
    const auto at = [&](int k) { return std::size_t(t[std::size_t(k)]); };
    const Vec3 ab = mesh.positions[at(1)] - mesh.positions[at(0)],
               ac = mesh.positions[at(2)] - mesh.positions[at(0)];
    const Vec2 u = mesh.uvs[at(1)] - mesh.uvs[at(0)], v = mesh.uvs[at(2)] - mesh.uvs[at(0)];
    const double twice = u.x() * v.y() - u.y() * v.x(), area = ab.cross(ac).norm();
    if (std::abs(twice) < 1e-12) continue;
    const Vec3 along_u = (v.y() * ab - u.y() * ac) / twice, along_v = (u.x() * ac - v.x() * ab) / twice;
    sum += area * Vec2(along_u.norm(), along_v.norm());
    total_area += area;
  }
  return total_area > 0 ? Vec2((sum / total_area).cwiseMax(1e-3)) : Vec2::Ones();
}

}  // namespace surface

}  // namespace intaglio
