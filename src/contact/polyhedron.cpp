#include "contact/polyhedron.h"

#include <fmt/format.h>
#include <libqhull_r/qhull_ra.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace intaglio::contact {

namespace {

using Loop = std::vector<int>;

void add_face(Polyhedron& form, const Loop& loop) {
  const auto vertex = [&](std::size_t k) -> const Vec3& { return form.vertices[std::size_t(loop[k])]; };
  Vec3 area = Vec3::Zero();
  for (std::size_t k = 1; k + 1 < loop.size(); ++k)
    area += (vertex(k) - vertex(0)).cross(vertex(k + 1) - vertex(0));
  const Vec3 normal = area.normalized();
  double offset = normal.dot(vertex(0));
  for (std::size_t k = 1; k < loop.size(); ++k) offset = std::max(offset, normal.dot(vertex(k)));
  form.faces.push_back({normal, offset, int(form.loop.size()), int(loop.size())});
  form.loop.insert(form.loop.end(), loop.begin(), loop.end());
}

// Half edges (from, to) and the face to their left.
using HalfEdges = std::map<std::pair<int, int>, int>;

// Half edges of all loops; an error when one belongs to two faces or has no partner the other way.
Result<HalfEdges> half_edges(const Polyhedron& form, const std::string& what) {
  HalfEdges half;
  for (std::size_t f = 0; f < form.faces.size(); ++f) {
    const Polyhedron::Face& face = form.faces[f];
    for (int k = 0; k < face.count; ++k) {
      const int a = form.loop[std::size_t(face.first + k)],
                b = form.loop[std::size_t(face.first + (k + 1) % face.count)];
      if (!half.emplace(std::pair(a, b), int(f)).second)
        return fail(what, fmt::format("edge {}-{}: two faces have the same orientation there", a, b),
                    "neighbouring faces must run along a shared edge in opposite directions");
    }
  }
  for (const auto& [edge, face] : half) {
    if (half.count({edge.second, edge.first}) == 0)
      return fail(what, fmt::format("edge {}-{} has a face on one side only", edge.first, edge.second),
                  "a closed polyhedron has two faces at every edge");
  }
  return half;
}

// Height above a plane of the vertex of a face that is farthest from it.
double farthest_above(const Polyhedron& form, const Polyhedron::Face& face, const Polyhedron::Face& plane) {
  double farthest = 0;
  for (int k = 0; k < face.count; ++k) {
    const Vec3& v = form.vertices[std::size_t(form.loop[std::size_t(face.first + k)])];
    const double height = plane.normal.dot(v) - plane.offset;
    if (std::abs(height) > std::abs(farthest)) farthest = height;
  }
  return farthest;
}

// Fills edges, neighbours and radius from vertices, faces and loop.
Result<void> link_faces(Polyhedron& form, const std::string& what) {
  const auto half = half_edges(form, what);
  if (!half) return tl::unexpected(half.error());
  std::vector<std::set<int>> around(form.vertices.size());
  for (const auto& [edge, left] : *half) {
    const auto [a, b] = edge;
    around[std::size_t(a)].insert(b);
    if (a > b) continue;
    const int right = half->at({b, a});
    const Polyhedron::Face &l = form.faces[std::size_t(left)], &r = form.faces[std::size_t(right)];
    const double length = (form.vertices[std::size_t(b)] - form.vertices[std::size_t(a)]).norm();
    if (form.convex || farthest_above(form, r, l) < -1e-9 * length) form.edges.push_back({a, b, left, right});
  }
  form.first_neighbour.push_back(0);
  for (const std::set<int>& ring : around) {
    form.neighbours.insert(form.neighbours.end(), ring.begin(), ring.end());
    form.first_neighbour.push_back(int(form.neighbours.size()));
  }
  double radius2 = 0;
  for (const Vec3& v : form.vertices) radius2 = std::max(radius2, v.squaredNorm());
  form.radius = std::sqrt(radius2);
  return {};
}

// Qhull's hull of some points. Its messages go nowhere: it writes them to a file only, or else to stderr.
class Qhull {
 public:
  explicit Qhull(std::span<const Vec3> points) : points_(points.begin(), points.end()) {
    messages_ = open_memstream(&text_, &text_bytes_);
    char command[] = "qhull Pp";  // no warnings of precision
    qh_zero(&qh_, messages_);
    error_ = qh_new_qhull(&qh_, 3, int(points_.size()), points_.front().data(), False, command, nullptr,
                          messages_);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;
  ~Qhull() {
    qh_freeqhull(&qh_, !qh_ALL);
    int bytes = 0, blocks = 0;
    qh_memfreeshort(&qh_, &bytes, &blocks);
    if (messages_ != nullptr) std::fclose(messages_);
    std::free(text_);
  }

  int error() const { return error_; }

  // The points at the corners of every face, counter-clockwise seen from outside, the lowest first; in order.
  // That order depends on nothing but which faces there are.
  std::vector<Loop> loops() {
    std::vector<Loop> all;
    for (const facetT* facet = qh_.facet_list; facet != nullptr && facet->next != nullptr;
         facet = facet->next) {
      Loop corners;
      vertexT *vertex, **vertexp;
      FOREACHvertex_(facet->vertices) corners.push_back(qh_pointid(&qh_, vertex->point));
      sort_around(Vec3(facet->normal[0], facet->normal[1], facet->normal[2]), corners);
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
      all.push_back(std::move(corners));
    }
    std::sort(all.begin(), all.end());
    return all;
  }

 private:
  // Sorts the corners of a convex polygon counter-clockwise around its normal.
  void sort_around(const Vec3& normal, Loop& corners) const {
    const auto point = [&](int k) -> const Vec3& { return points_[std::size_t(k)]; };
    Vec3 middle = Vec3::Zero();
    for (const int k : corners) middle += point(k) / double(corners.size());
    const Vec3 start = point(corners.front()) - middle, across = normal.cross(start);
    // Grows with the angle from `start`: 0..2 in the first half turn, 2..4 in the second.
    const auto angle = [&](int k) {
      const Vec3 d = point(k) - middle;
      const double x = d.dot(start) / start.norm(), y = d.dot(across) / across.norm();
      const double cosine = x / std::sqrt(x * x + y * y);
      return y >= 0 ? 1 - cosine : 3 + cosine;
    };
    std::sort(corners.begin() + 1, corners.end(), [&](int a, int b) { return angle(a) < angle(b); });
  }

  std::vector<Vec3> points_;
  qhT qh_;
  int error_ = 0;
  char* text_ = nullptr;
  std::size_t text_bytes_ = 0;
  std::FILE* messages_ = nullptr;
};

}  // namespace

Result<std::shared_ptr<const Polyhedron>> convex_hull(std::span<const Vec3> points) {
  const std::string what = "convex hull";
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (!points[k].allFinite())
      return fail(what, fmt::format("point {} is not finite", k), "coordinates in metres");
  }
  if (points.size() < 4) return fail(what, fmt::format("{} points", points.size()), "four or more points");
  if (std::all_of(points.begin(), points.end(), [&](const Vec3& p) { return p == points[0]; }))
    return fail(what, "all points are the same", "points that span a volume");
  Qhull hull(points);
  if (hull.error() == qh_ERRsingular)
    return fail(what, "all points are in one plane", "points that span a volume");
  if (hull.error() != 0)
    return fail(what, fmt::format("Qhull cannot build it (its error {})", hull.error()),
                "drop points that are nearly coplanar, or move them apart");
  const std::vector<Loop> loops = hull.loops();
  Polyhedron form;
  std::map<int, int> vertex;  // point -> vertex
  for (const Loop& loop : loops) {
    for (const int point : loop) vertex.emplace(point, 0);
  }
  if (vertex.size() > max_hull_points)
    return fail(what, fmt::format("{} corners", vertex.size()),
                fmt::format("at most {} corners", max_hull_points));
  for (auto& [point, index] : vertex) {
    index = int(form.vertices.size());
    form.vertices.push_back(points[std::size_t(point)]);
  }
  for (Loop loop : loops) {
    for (int& corner : loop) corner = vertex.at(corner);
    add_face(form, loop);
  }
  if (auto linked = link_faces(form, what); !linked) return tl::unexpected(linked.error());
  return std::make_shared<const Polyhedron>(std::move(form));
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
        return fail(what,
                    fmt::format("triangle {} uses vertex {}, but there are {}", k, index, vertices.size()),
                    "indices below the number of vertices");
    }
    const Vec3 &a = vertices[std::size_t(t[0])], &b = vertices[std::size_t(t[1])],
               &c = vertices[std::size_t(t[2])];
    const Vec3 area = (b - a).cross(c - a);
    if (!(area.norm() > 1e-12 * ((b - a).squaredNorm() + (c - a).squaredNorm())))
      return fail(what, fmt::format("triangle {} has no area", k), "triangles without doubled corners");
    const Vec3 normal = area.normalized();
    form.faces.push_back({normal, normal.dot(a), int(form.loop.size()), 3});
    form.loop.insert(form.loop.end(), t.begin(), t.end());
    volume += a.dot(b.cross(c)) / 6;
  }
  if (!(volume > 0))
    return fail(what, fmt::format("is inside out: its signed volume is {:.3g} m^3", volume),
                "triangles counter-clockwise seen from outside");
  if (auto linked = link_faces(form, what); !linked) return tl::unexpected(linked.error());
  return std::make_shared<const Polyhedron>(std::move(form));
}

Polyhedron make_cube() {
  Polyhedron form;
  form.vertices = {{-1, -1, -1}, {-1, 1, -1}, {1, 1, -1}, {1, -1, -1},
                   {1, -1, 1},   {-1, -1, 1}, {1, 1, 1},  {-1, 1, 1}};
  for (const Loop& loop : std::initializer_list<Loop>{
           {0, 1, 2, 3}, {0, 3, 4, 5}, {3, 2, 6, 4}, {0, 5, 7, 1}, {1, 7, 6, 2}, {5, 4, 6, 7}})
    add_face(form, loop);
  (void)link_faces(form, "cube");
  return form;
}

}  // namespace intaglio::contact
