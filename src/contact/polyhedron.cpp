#include "contact/polyhedron.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <fmt/format.h>

namespace intaglio::contact {

namespace {

// How far the vertex of a face that is farthest from a plane is above it.
double farthest_above(const Polyhedron& form, const Polyhedron::Face& face, const Polyhedron::Face& plane) {
  double above = 0;
  for (int k = 0; k < face.count; ++k) {
    const Vec3& v = form.vertices[std::size_t(form.loop[std::size_t(face.first + k)])];
    const double at = plane.normal.dot(v) - plane.offset;
    if (std::abs(at) > std::abs(above)) above = at;
  }
  return above;
}

}  // namespace

Result<HalfEdges> half_edges(const Polyhedron& form, const std::string& what) {
  HalfEdges half;
  for (std::size_t f = 0; f < form.faces.size(); ++f) {
    const Polyhedron::Face& face = form.faces[f];
    for (int k = 0; k < face.count; ++k) {
      const int a = form.loop[std::size_t(face.first + k)],
                b = form.loop[std::size_t(face.first + (k + 1) % face.count)];
      if (!half.emplace(std::pair(a, b), static_cast<int>(f)).second)
        return fail(what, fmt::format("edge {}-{} belongs to two triangles that run the same way", a, b),
                    "triangles that share an edge run along it in opposite directions");
    }
  }
  for (const auto& [edge, face] : half) {
    if (half.count({edge.second, edge.first}) == 0)
      return fail(what, fmt::format("edge {}-{} has a triangle on one side only", edge.first, edge.second),
                  "a closed mesh has two triangles at every edge");
  }
  return half;
}

void link(Polyhedron& form, const HalfEdges& half) {
  std::vector<std::set<int>> around(form.vertices.size());
  for (const auto& [edge, left] : half) {
    const auto [a, b] = edge;
    around[std::size_t(a)].insert(b);
    if (a > b) continue;
    const int right = half.at({b, a});
    const Polyhedron::Face &l = form.faces[std::size_t(left)], &r = form.faces[std::size_t(right)];
    const double length = (form.vertices[std::size_t(b)] - form.vertices[std::size_t(a)]).norm();
    if (form.convex || farthest_above(form, r, l) < -1e-9 * length) form.edges.push_back({a, b, left, right});
  }
  form.first_neighbour.push_back(0);
  for (const std::set<int>& ring : around) {
    form.neighbours.insert(form.neighbours.end(), ring.begin(), ring.end());
    form.first_neighbour.push_back(static_cast<int>(form.neighbours.size()));
  }
  double radius2 = 0;
  for (const Vec3& v : form.vertices) radius2 = std::max(radius2, v.squaredNorm());
  form.radius = std::sqrt(radius2);
}

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
