#include "render/mesh.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace intaglio::render {

Mesh lathe(std::span<const ProfilePoint> profile, int slices) {
  Mesh mesh;
  const auto columns = std::uint32_t(profile.size());
  for (int slice = 0; slice <= slices; ++slice) {
    const double angle = 2 * std::numbers::pi * slice / slices;
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    for (const ProfilePoint& p : profile) {
      mesh.vertices.push_back({{float(p.radius * c), float(p.radius * s), float(p.z)},
                               {float(p.normal_radius * c), float(p.normal_radius * s), float(p.normal_z)}});
    }
  }
  for (std::uint32_t slice = 0; slice < std::uint32_t(slices); ++slice) {
    for (std::uint32_t k = 0; k + 1 < columns; ++k) {
      const std::uint32_t here = slice * columns + k;
      const std::uint32_t next = here + columns;
      for (const std::uint32_t corner : {here, next, next + 1, here, next + 1, here + 1})
        mesh.indices.push_back(corner);
    }
  }
  return mesh;
}

Mesh unit_sphere(int slices) {
  std::vector<ProfilePoint> half_circle;
  const int stacks = slices / 2;
  for (int k = 0; k <= stacks; ++k) {
    const double angle = std::numbers::pi * (double(k) / stacks - 0.5);
    half_circle.push_back({std::cos(angle), std::sin(angle), std::cos(angle), std::sin(angle)});
  }
  return lathe(half_circle, slices);
}

Mesh pen_mesh(double length, double radius, int slices) {
  const double cone = std::min(pen_tip_radii * radius, length);
  const double slope = 1 / std::hypot(radius, cone);  // the cone's normal is (cone, -radius) * slope
  const std::array<ProfilePoint, 6> profile = {{{0, 0, cone * slope, -radius * slope},
                                                {radius, cone, cone * slope, -radius * slope},
                                                {radius, cone, 1, 0},
                                                {radius, length, 1, 0},
                                                {radius, length, 0, 1},
                                                {0, length, 0, 1}}};
  return lathe(profile, slices);
}

namespace {

Vertex vertex(const Vec3& p, const Vec3& n) {
  return {{float(p.x()), float(p.y()), float(p.z())}, {float(n.x()), float(n.y()), float(n.z())}};
}

// Two triangles of the square with corners a, b above c, d, as seen from its front.
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

// The wall under one side of the relief: the vertices `first`, `first + stride`, ... from left to right as
// seen from outside.
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

namespace {

struct Corner {
  Vec3 world, texture;
};

// Orients the tetrahedron positively; skips a degenerate one.
void add_tetrahedron(std::vector<Tetrahedron>& out, std::array<Corner, 4> c, double min_volume) {
  const auto edge = [&](int k) -> Vec3 { return c[std::size_t(k)].world - c[0].world; };
  const double volume = edge(1).cross(edge(2)).dot(edge(3));
  if (!(std::abs(volume) > min_volume)) return;
  if (volume < 0) std::swap(c[1], c[2]);
  Tetrahedron t;
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      t.corner[k][i] = float(c[k].world[Eigen::Index(i)]);
      t.texture[k][i] = float(c[k].texture[Eigen::Index(i)]);
    }
  }
  out.push_back(t);
}

}  // namespace

Result<std::vector<Tetrahedron>> shell_tetrahedra(const surface::TriangleMesh& base, double depth,
                                                  const Vec2& size, const std::string& name) {
  constexpr double slack = 1e-6;  // of a texture, for UVs that are written in decimals
  std::vector<Tetrahedron> out;
  out.reserve(3 * base.triangles.size());
  for (std::size_t k = 0; k < base.triangles.size(); ++k) {
    // Sorting by vertex index makes neighbours split their shared quad along the same diagonal.
    surface::Triangle triangle = base.triangles[k];
    std::sort(triangle.begin(), triangle.end());
    const auto uv_of = [&](int i) -> const Vec2& { return base.uvs[std::size_t(triangle[std::size_t(i)])]; };
    const Vec2 low = uv_of(0).cwiseMin(uv_of(1)).cwiseMin(uv_of(2));
    const Vec2 high = uv_of(0).cwiseMax(uv_of(1)).cwiseMax(uv_of(2));
    const Vec2 tile = (low.array() + slack).floor();
    if (((high - tile).array() > 1 + slack).any()) {
      return fail(
          name,
          fmt::format("triangle {} spans ({:.4g}, {:.4g}) to ({:.4g}, {:.4g}) in UV, across a tile edge", k,
                      low.x(), low.y(), high.x(), high.y()),
          "split triangles at integer u and v where the texture repeats");
    }
    std::array<Corner, 3> top, bottom;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto at = std::size_t(triangle[i]);
      const Vec2 uv = (base.uvs[at] - tile).cwiseProduct(size);
      top[i] = {base.positions[at], Vec3(uv.x(), uv.y(), 0)};
      bottom[i] = {base.positions[at] - depth * base.normals[at], Vec3(uv.x(), uv.y(), -depth)};
    }
    const Vec3 across = (top[1].world - top[0].world).cross(top[2].world - top[0].world);
    const double min_volume = 1e-7 * across.norm() * depth;
    add_tetrahedron(out, {bottom[0], bottom[1], bottom[2], top[2]}, min_volume);
    add_tetrahedron(out, {bottom[0], bottom[1], top[1], top[2]}, min_volume);
    add_tetrahedron(out, {bottom[0], top[0], top[1], top[2]}, min_volume);
  }
  if (out.empty()) return fail(name, "has no triangle of non-zero area");
  return out;
}

}  // namespace intaglio::render
