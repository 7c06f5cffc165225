#include "intaglio/contact/polyhedron_links.h"

namespace intaglio::contact {

Result<std::shared_ptr<const Polyhedron>> closed_mesh(std::span<const Vec3> vertices,
                                                      std::span<const std::array<int, 3>> triangles) {
  const std::string what = "closed mesh";
  if (triangles.size() < 4 || triangles.size() > max_mesh_triangles)
    return fail(what, fmt::format("{} triangles", triangles.size()),
                fmt::format("4 to {} triangles", max_mesh_triangles));
  Polyhedron form;
  form.convex = false;
  form.vertices.assign(vertices.begin(), vertices.end());
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    if (!vertices[k].allFinite())
      return fail(what, fmt::format("vertex {} is not finite", k), "coordinates in metres");
  }
  double volume = 0;
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    const std::array<int, 3>& t = triangles[k];
    for (const int index : t) {
      if (index < 0 || std::size_t(index) >= vertices.size())
        return fail(what, fmt::format("triangle {} names vertex {} of {}", k, index, vertices.size()),
                    "indices below the number of vertices");
    }
    const Vec3 &a = vertices[std::size_t(t[0])], &b = vertices[std::size_t(t[1])],
               &c = vertices[std::size_t(t[2])];
    const Vec3 across = (b - a).cross(c - a);
    if (!(across.norm() > 1e-12 * ((b - a).squaredNorm() + (c - a).squaredNorm())))
      return fail(what, fmt::format("triangle {} has no area", k), "triangles without doubled corners");
    const Vec3 normal = across.normalized();
    form.faces.push_back({normal, normal.dot(a), static_cast<int>(form.loop.size()), 3});
    form.loop.insert(form.loop.end(), t.begin(), t.end());
    volume += a.dot(b.cross(c)) / 6;
  }
  if (!(volume > 0))
    return fail(what, fmt::format("its volume is {:.3g} m^3", volume),
                "triangles counter-clockwise seen from outside");
  const auto half = half_edges(form, what);
  if (!half) return tl::unexpected(half.error());
  link(form, *half);
  return std::make_shared<const Polyhedron>(std::move(form));
}

}  // namespace intaglio::contact
