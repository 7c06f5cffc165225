#include "intaglio/render/slab_mesh.h"

namespace intaglio::render {

namespace {

Vertex vertex(const Vec3& p, const Vec3& n) {
  return {{float(p.x()), float(p.y()), float(p.z())}, {float(n.x()), float(n.y()), float(n.z())}};
}

// Two triangles of corners a, b over c, d; seen from their front, a to b is to the right and c is below a.
void add_square(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  for (const std::uint32_t k : {c, b, a, c, d, b}) mesh.indices.push_back(k);
}

void add_relief(Mesh& mesh, const surface::Surface& surface, int cells) {
  const auto& place = surface.placement();
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= cells; ++i) {
      const Vec2 uv(double(i) / cells, double(j) / cells);
      mesh.vertices.push_back(
          vertex({uv.x() * place.size_u(), uv.y() * place.size_v(), -surface.depth(uv)}, surface.normal(uv)));
    }
  }
  const std::uint32_t row = std::uint32_t(cells) + 1;
  for (std::uint32_t j = 0; j + 1 < row; ++j)
    for (std::uint32_t i = 0; i + 1 < row; ++i)
      add_square(mesh, (j + 1) * row + i, (j + 1) * row + i + 1, j * row + i, j * row + i + 1);
}

// The wall under one side of the relief, whose corners are `first`, `first + stride`, ... from left to right
// as seen from outside.
void add_wall(Mesh& mesh, int cells, std::int64_t first, std::int64_t stride, const Vec3& outwards,
              double slab) {
  const auto base = std::uint32_t(mesh.vertices.size());
  for (int k = 0; k <= cells; ++k) {
    const auto& at = mesh.vertices[std::size_t(first + k * stride)].position;
    const Vec3 p(at[0], at[1], at[2]);
    mesh.vertices.push_back(vertex(p, outwards));
    mesh.vertices.push_back(vertex({p.x(), p.y(), -slab}, outwards));
  }
  for (std::uint32_t k = base; k < base + 2 * std::uint32_t(cells); k += 2)
    add_square(mesh, k, k + 2, k + 1, k + 3);
}

}  // namespace

Mesh slab_mesh(const surface::Surface& surface, int cells, double slab) {
  const std::size_t row = std::size_t(cells) + 1, corners = row * row + 8 * row + 4;
  Mesh mesh;
  mesh.vertices.reserve(corners);
  mesh.indices.reserve(6 * corners);
  add_relief(mesh, surface, cells);
  const auto last = std::int64_t(row) - 1, top = std::int64_t(row) * last;
  add_wall(mesh, cells, 0, 1, -Vec3::UnitY(), slab);
  add_wall(mesh, cells, last, std::int64_t(row), Vec3::UnitX(), slab);
  add_wall(mesh, cells, top + last, -1, Vec3::UnitY(), slab);
  add_wall(mesh, cells, top, -std::int64_t(row), -Vec3::UnitX(), slab);
  const auto& place = surface.placement();
  const auto floor = std::uint32_t(mesh.vertices.size());
  for (const Vec2& uv : {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1), Vec2(1, 1)})
    mesh.vertices.push_back(
        vertex({uv.x() * place.size_u(), uv.y() * place.size_v(), -slab}, -Vec3::UnitZ()));
  add_square(mesh, floor, floor + 1, floor + 2, floor + 3);
  return mesh;
}

}  // namespace intaglio::render
