// Source of the incremental hull: de Berg et al., "Computational geometry", 2008, chapter 11.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <fmt/format.h>

#include "contact/polyhedron.h"

namespace intaglio::contact {

namespace {

constexpr const char* what = "convex hull";  // asked before main, too

struct Triangle {
  std::array<int, 3> v;
  Vec3 normal;
  double offset;
};

class Hull {
 public:
  explicit Hull(std::span<const Vec3> points) : points_(points) {
    for (const Vec3& p : points) scale_ = std::max(scale_, (p - points[0]).norm());
    flat_ = 1e-10 * scale_;
  }

  // Four points that span a volume; false when all are in one plane.
  bool start() {
    const std::size_t a = 0;
    const std::size_t b = farthest([&](const Vec3& p) { return (p - points_[a]).norm(); });
    if (!(scale_ > 0)) return false;
    const Vec3 along = (points_[b] - points_[a]).normalized();
    const std::size_t c = farthest([&](const Vec3& p) { return along.cross(p - points_[a]).norm(); });
    const Vec3 across = along.cross(points_[c] - points_[a]);
    if (!(across.norm() > flat_)) return false;
    const Vec3 normal = across.normalized();
    const std::size_t d = farthest([&](const Vec3& p) { return std::abs(normal.dot(p - points_[a])); });
    if (!(std::abs(normal.dot(points_[d] - points_[a])) > flat_)) return false;
    int i = int(a), j = int(b);
    const int k = int(c), l = int(d);
    if (normal.dot(points_[d] - points_[a]) > 0) std::swap(i, j);
    for (const std::array<int, 3>& t :
         {std::array{i, j, k}, std::array{i, l, j}, std::array{j, l, k}, std::array{k, l, i}})
      add(t);
    return true;
  }

  void grow() {
    for (std::size_t p = 0; p < points_.size(); ++p) include(int(p));
  }

  const std::vector<Triangle>& triangles() const { return triangles_; }
  double flat() const { return flat_; }

 private:
  template <class Measure>
  std::size_t farthest(const Measure& measure) const {
    std::size_t best = 0;
    for (std::size_t k = 1; k < points_.size(); ++k) {
      if (measure(points_[k]) > measure(points_[best])) best = k;
    }
    return best;
  }
  void add(const std::array<int, 3>& t) {
    const Vec3 &a = at(t[0]), &b = at(t[1]), &c = at(t[2]);
    const Vec3 normal = (b - a).cross(c - a).normalized();
    triangles_.push_back({t, normal, normal.dot(a)});
  }
  const Vec3& at(int k) const { return points_[std::size_t(k)]; }
  double above(const Triangle& t, int p) const { return t.normal.dot(at(p)) - t.offset; }

  // Faces that the point is above, or level with, give way to faces from their outline to the point.
  void include(int p) {
    if (std::none_of(triangles_.begin(), triangles_.end(),
                     [&](const Triangle& t) { return above(t, p) > flat_; }))
      return;
    std::map<std::pair<int, int>, int> outline;
    std::vector<Triangle> kept;
    for (const Triangle& t : triangles_) {
      if (above(t, p) < -flat_) {
        kept.push_back(t);
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) outline[{t.v[k], t.v[(k + 1) % 3]}] = 1;
    }
    triangles_ = std::move(kept);
    for (const auto& [edge, one] : outline) {
      if (outline.count({edge.second, edge.first}) == 0) add({edge.first, edge.second, p});
    }
  }

  std::span<const Vec3> points_;
  double scale_ = 0, flat_ = 0;
  std::vector<Triangle> triangles_;
};

// Triangles in one plane, as groups: the group of each.
std::vector<int> planes(const std::vector<Triangle>& triangles) {
  std::map<std::pair<int, int>, int> left;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k)
      left[{triangles[t].v[k], triangles[t].v[(k + 1) % 3]}] = static_cast<int>(t);
  }
  std::vector<int> group(triangles.size());
  std::iota(group.begin(), group.end(), 0);
  const auto root = [&](int t) {
    while (group[std::size_t(t)] != t) t = group[std::size_t(t)];
    return t;
  };
  for (const auto& [edge, t] : left) {
    const auto other = left.find({edge.second, edge.first});
    if (other == left.end()) continue;
    const Vec3 &n = triangles[std::size_t(t)].normal, &m = triangles[std::size_t(other->second)].normal;
    if (n.cross(m).norm() < 1e-7 && n.dot(m) > 0) group[std::size_t(root(t))] = root(other->second);
  }
  for (std::size_t t = 0; t < group.size(); ++t) group[t] = root(static_cast<int>(t));
  return group;
}

// One face a group: its outline, one loop.
Result<Polyhedron> joined(std::span<const Vec3> points, const std::vector<Triangle>& triangles) {
  const std::vector<int> group = planes(triangles);
  std::map<int, std::map<int, int>> next;  // group -> from -> to
  std::map<int, Vec3> normal;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    std::map<int, int>& outline = next[group[t]];
    const Triangle& tri = triangles[t];
    normal.emplace(group[t], Vec3::Zero()).first->second +=
        (points[std::size_t(tri.v[1])] - points[std::size_t(tri.v[0])])
            .cross(points[std::size_t(tri.v[2])] - points[std::size_t(tri.v[0])]);
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = tri.v[k], b = tri.v[(k + 1) % 3];
      const bool inner = std::any_of(triangles.begin(), triangles.end(), [&](const Triangle& other) {
        if (group[std::size_t(&other - triangles.data())] != group[t]) return false;
        for (std::size_t n = 0; n < 3; ++n) {
          if (other.v[n] == b && other.v[(n + 1) % 3] == a) return true;
        }
        return false;
      });
      if (!inner) outline[a] = b;
    }
  }
  Polyhedron form;
  std::map<int, int> vertex;  // point -> vertex
  for (const auto& [g, outline] : next) {
    Polyhedron::Face face{normal[g].normalized(), 0, static_cast<int>(form.loop.size()), 0};
    int at = outline.begin()->first;
    do {
      const auto [found, is_new] = vertex.emplace(at, static_cast<int>(form.vertices.size()));
      if (is_new) form.vertices.push_back(points[std::size_t(at)]);
      form.loop.push_back(found->second);
      face.offset = face.count == 0 ? face.normal.dot(points[std::size_t(at)])
                                    : std::max(face.offset, face.normal.dot(points[std::size_t(at)]));
      ++face.count;
      const auto to = outline.find(at);
      if (to == outline.end() || std::size_t(face.count) > outline.size())
        return fail(what, "its faces do not close", "points that are not almost in one plane");
      at = to->second;
    } while (at != outline.begin()->first);
    form.faces.push_back(face);
  }
  return form;
}

}  // namespace

Result<std::shared_ptr<const Polyhedron>> convex_hull(std::span<const Vec3> points) {
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (!points[k].allFinite())
      return fail(what, fmt::format("point {} is not finite", k), "coordinates in metres");
  }
  if (points.size() < 4) return fail(what, fmt::format("{} points", points.size()), "four or more points");
  Hull hull(points);
  if (!hull.start()) return fail(what, "all points are in one plane", "points that span a volume");
  hull.grow();
  auto form = joined(points, hull.triangles());
  if (!form) return tl::unexpected(form.error());
  if (form->vertices.size() > max_hull_points)
    return fail(what, fmt::format("{} corners", form->vertices.size()),
                fmt::format("{} corners at most", max_hull_points));
  const auto half = half_edges(*form, what);
  if (!half) return tl::unexpected(half.error());
  link(*form, *half);
  return std::make_shared<const Polyhedron>(std::move(*form));
}

}  // namespace intaglio::contact
