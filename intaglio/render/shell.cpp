#include "intaglio/render/shell.h"

#include <algorithm>
#include <cmath>

namespace intaglio::render {

namespace {

struct Corner {
  Vec3 world, texture;
};

// Turned so that its volume is positive; none where it has none.
void add(std::vector<Tetrahedron>& out, std::array<Corner, 4> c, double least_volume) {
  const auto edge = [&](int k) -> Vec3 { return c[std::size_t(k)].world - c[0].world; };
  const double volume = edge(1).cross(edge(2)).dot(edge(3));
  if (!(std::abs(volume) > least_volume)) return;
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

Result<std::vector<Tetrahedron>> make_shell(const surface::TriangleMesh& base, double depth, const Vec2& size,
                                            const std::string& name) {
  std::vector<Tetrahedron> out;
  out.reserve(3 * base.triangles.size());
  for (std::size_t k = 0; k < base.triangles.size(); ++k) {
    // Neighbours cut their common side along the same diagonal when both go by the order of the vertices.
    surface::Triangle triangle = base.triangles[k];
    std::sort(triangle.begin(), triangle.end());
    const auto uv_of = [&](int i) -> const Vec2& { return base.uvs[std::size_t(triangle[std::size_t(i)])]; };
    const Vec2 low = uv_of(0).cwiseMin(uv_of(1)).cwiseMin(uv_of(2)),
               high = uv_of(0).cwiseMax(uv_of(1)).cwiseMax(uv_of(2));
    const Vec2 tile = (low.array() + 1e-6).floor();
    if (((high - tile).array() > 1 + 1e-6).any()) {
      return fail(name,
                  fmt::format("triangle {} reaches from ({:.4g}, {:.4g}) to ({:.4g}, {:.4g}) in the texture",
                              k, low.x(), low.y(), high.x(), high.y()),
                  "to draw a repeated texture, cut triangles along whole numbers of u and v");
    }
    std::array<Corner, 3> top, bottom;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto at = std::size_t(triangle[i]);
      const Vec2 uv = (base.uvs[at] - tile).cwiseProduct(size);
      top[i] = {base.positions[at], Vec3(uv.x(), uv.y(), 0)};
      bottom[i] = {base.positions[at] - depth * base.normals[at], Vec3(uv.x(), uv.y(), -depth)};
    }
    const Vec3 across = (top[1].world - top[0].world).cross(top[2].world - top[0].world);
    const double least = 1e-7 * across.norm() * depth;
    add(out, {bottom[0], bottom[1], bottom[2], top[2]}, least);
    add(out, {bottom[0], bottom[1], top[1], top[2]}, least);
    add(out, {bottom[0], top[0], top[1], top[2]}, least);
  }
  if (out.empty()) return fail(name, "has no triangle with an area for relief to lie on");
  return out;
}

}  // namespace intaglio::render
