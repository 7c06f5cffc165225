#include "intaglio/contact/polyhedron_links.h"

#include <algorithm>
#include <cmath>
#include <set>

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

}  // namespace intaglio::contact
