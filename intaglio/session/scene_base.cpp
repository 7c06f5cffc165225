#include "intaglio/session/scene_base.h"

#include <algorithm>
#include <cmath>

#include "intaglio/surface/mesh/mesh_file.h"
#include "intaglio/surface/mesh/mesh_shapes.h"

namespace intaglio::session {

namespace {

// So many that a ball rolls on it and not on a polygon; whole textures have whole numbers of them.
int pieces(int wanted, double repeat) {
  const int times = static_cast<int>(repeat);
  return times * ((wanted + times - 1) / times);
}

Result<surface::TriangleMesh> mesh_of(const BaseScene& base) {
  const int around = pieces(64, base.repeat.x()), up = pieces(32, base.repeat.y());
  switch (base.shape) {
    case BaseScene::Shape::cylinder:
      return surface::make_cylinder(base.radius, base.height, around, pieces(1, base.repeat.y()));
    case BaseScene::Shape::sphere:
      return surface::make_sphere(base.radius, around, up);
    case BaseScene::Shape::mesh:
      return surface::read_mesh(base.file);
    default:
      return surface::make_bowl(base.radius, around, up);
  }
}

}  // namespace

Result<surface::MeshPlacement> make_base(const BaseScene& base, const Pose& pose) {
  auto mesh = mesh_of(base);
  if (!mesh) return tl::unexpected(mesh.error());
  for (Vec2& uv : mesh->uvs) uv = uv.cwiseProduct(base.repeat);
  return surface::MeshPlacement::make(surface::moved(std::move(*mesh), pose),
                                      base.file.empty() ? "base" : base.file);
}

Vec2 texture_size(const surface::TriangleMesh& mesh) {
  Vec2 sum = Vec2::Zero();
  double whole = 0;
  for (const surface::Triangle& t : mesh.triangles) {
    const auto at = [&](int k) { return static_cast<std::size_t>(t[static_cast<std::size_t>(k)]); };
    const Vec3 ab = mesh.positions[at(1)] - mesh.positions[at(0)],
               ac = mesh.positions[at(2)] - mesh.positions[at(0)];
    const Vec2 u = mesh.uvs[at(1)] - mesh.uvs[at(0)], v = mesh.uvs[at(2)] - mesh.uvs[at(0)];
    const double twice = u.x() * v.y() - u.y() * v.x(), area = ab.cross(ac).norm();
    if (std::abs(twice) < 1e-12) continue;
    const Vec3 along_u = (v.y() * ab - u.y() * ac) / twice, along_v = (u.x() * ac - v.x() * ab) / twice;
    sum += area * Vec2(along_u.norm(), along_v.norm());
    whole += area;
  }
  return whole > 0 ? Vec2((sum / whole).cwiseMax(1e-3)) : Vec2::Ones();
}

}  // namespace intaglio::session
