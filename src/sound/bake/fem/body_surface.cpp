#include "sound/bake/fem/body_surface.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

namespace intaglio::sound {

namespace {

constexpr double weld_tolerance = 1e-7;  // of the bounding box's diagonal
constexpr double same_place = 1e-6;      // of a segment: crossings as near as that count as one

struct EdgeUse {
  int triangle;
  bool forward;  // from the lower to the higher vertex
};

void bounds(BodySurface& body, const std::vector<Vec3>& points) {
  body.low = body.high = points.front();
  for (const Vec3& p : points) {
    body.low = body.low.cwiseMin(p);
    body.high = body.high.cwiseMax(p);
  }
}

void weld_points(BodySurface& body, const surface::TriangleMesh& mesh) {
  const double cell = weld_tolerance * (body.high - body.low).norm();
  std::map<std::array<std::int64_t, 3>, int> at;
  std::vector<int> number;
  for (const Vec3& p : mesh.positions) {
    const Vec3 q = (p - body.low) / cell;
    const auto [found, is_new] = at.try_emplace(
        {std::llround(q.x()), std::llround(q.y()), std::llround(q.z())}, int(body.points.size()));
    if (is_new) body.points.push_back(p);
    number.push_back(found->second);
  }
  for (const auto& t : mesh.triangles) {
    const Triangle welded{number[std::size_t(t[0])], number[std::size_t(t[1])], number[std::size_t(t[2])]};
    if (welded[0] != welded[1] && welded[1] != welded[2] && welded[2] != welded[0])
      body.triangles.push_back(welded);
  }
  if (const auto dropped = mesh.triangles.size() - body.triangles.size(); dropped > 0)
    body.notes.push_back(fmt::format("{} degenerate triangles were dropped", dropped));
}

using Edges = std::map<std::pair<int, int>, std::vector<EdgeUse>>;

Edges find_edges(const BodySurface& body) {
  Edges edges;
  for (std::size_t t = 0; t < body.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = body.triangles[t][k], b = body.triangles[t][(k + 1) % 3];
      edges[std::minmax(a, b)].push_back({int(t), a < b});
    }
  }
  return edges;
}

bool is_balanced(const std::vector<EdgeUse>& uses) {
  const auto forward =
      std::count_if(uses.begin(), uses.end(), [](const EdgeUse& use) { return use.forward; });
  return 2 * forward == std::ptrdiff_t(uses.size());
}

// Six times the signed volume between a triangle and a point.
double signed_volume6(const BodySurface& body, const Triangle& t, const Vec3& apex) {
  const auto at = [&](std::size_t k) { return Vec3(body.points[std::size_t(t[k])] - apex); };
  return at(0).dot(at(1).cross(at(2)));
}

struct Shells {
  std::vector<int> shell_of;     // each triangle
  std::vector<bool> is_flipped;  // each triangle: it winds against the first of its shell
  std::vector<double> volume;
  std::vector<int> flips;  // flipped triangles of each shell
  std::vector<Vec3> low, high;
};

Shells find_shells(const BodySurface& body, const Edges& edges) {
  std::vector<std::vector<std::pair<int, bool>>> neighbours(
      body.triangles.size());  // and whether both wind alike
  const auto join = [&](int a, int b, bool same_winding) {
    neighbours[std::size_t(a)].emplace_back(b, same_winding);
    neighbours[std::size_t(b)].emplace_back(a, same_winding);
  };
  for (const auto& [edge, uses] : edges) {
    if (uses.size() == 2) {
      join(uses[0].triangle, uses[1].triangle, uses[0].forward != uses[1].forward);
    } else if (is_balanced(uses)) {
      // More than two, and as many each way: winding is consistent.
      for (const EdgeUse& use : uses) {
        if (use.forward != uses[0].forward) join(uses[0].triangle, use.triangle, true);
        if (use.forward == uses[0].forward && &use != &uses[0]) {
          const auto other = std::find_if(uses.begin(), uses.end(),
                                          [&](const EdgeUse& u) { return u.forward != use.forward; });
          join(use.triangle, other->triangle, true);
        }
      }
    }
  }
  Shells shells;
  shells.shell_of.assign(body.triangles.size(), -1);
  shells.is_flipped.assign(body.triangles.size(), false);
  for (std::size_t seed = 0; seed < body.triangles.size(); ++seed) {
    if (shells.shell_of[seed] >= 0) continue;
    const auto shell = int(shells.volume.size());
    std::vector<std::size_t> members{seed};
    shells.shell_of[seed] = shell;
    int flips = 0;
    double volume = 0;
    Vec3 low = Vec3::Constant(1e300), high = -low;
    for (std::size_t k = 0; k < members.size(); ++k) {
      const std::size_t t = members[k];
      flips += shells.is_flipped[t];
      volume += (shells.is_flipped[t] ? -1 : 1) *
                signed_volume6(body, body.triangles[t], 0.5 * (body.low + body.high)) / 6;
      for (const int p : body.triangles[t]) {
        low = low.cwiseMin(body.points[std::size_t(p)]);
        high = high.cwiseMax(body.points[std::size_t(p)]);
      }
      for (const auto& [next, same_winding] : neighbours[t]) {
        if (shells.shell_of[std::size_t(next)] >= 0) continue;
        shells.shell_of[std::size_t(next)] = shell;
        shells.is_flipped[std::size_t(next)] = same_winding ? shells.is_flipped[t] : !shells.is_flipped[t];
        members.push_back(std::size_t(next));
      }
    }
    shells.volume.push_back(volume);
    shells.flips.push_back(flips);
    shells.low.push_back(low);
    shells.high.push_back(high);
  }
  return shells;
}

// A shell whose windings agreed may face inwards for a reason: it is the wall of a cavity in another one.
bool is_cavity(const Shells& shells, std::size_t shell) {
  if (shells.flips[shell] != 0) return false;
  for (std::size_t other = 0; other < shells.volume.size(); ++other) {
    if (other != shell && shells.volume[other] > -shells.volume[shell] &&
        (shells.low[other].array() < shells.low[shell].array()).all() &&
        (shells.high[other].array() > shells.high[shell].array()).all())
      return true;
  }
  return false;
}

void orient_outwards(BodySurface& body, const Shells& shells) {
  std::vector<bool> inwards(shells.volume.size());
  for (std::size_t s = 0; s < inwards.size(); ++s) inwards[s] = shells.volume[s] < 0 && !is_cavity(shells, s);
  int flipped = 0;
  for (std::size_t t = 0; t < body.triangles.size(); ++t) {
    if (shells.is_flipped[t] == inwards[std::size_t(shells.shell_of[t])]) continue;
    std::swap(body.triangles[t][1], body.triangles[t][2]);
    ++flipped;
  }
  if (flipped > 0)
    body.notes.push_back(
        fmt::format("{} of {} triangles faced inwards and were flipped", flipped, body.triangles.size()));
}

void count_edges(BodySurface& body) {
  int non_manifold = 0;
  for (const auto& [edge, uses] : find_edges(body)) {
    body.open_edges += !is_balanced(uses);
    non_manifold += uses.size() > 2;
  }
  if (body.open_edges > 0)
    body.notes.push_back(
        fmt::format("{} edges are open; winding numbers decide what is inside", body.open_edges));
  if (non_manifold > 0)
    body.notes.push_back(fmt::format("{} edges have more than two triangles", non_manifold));
  if (body.shells > 1) body.notes.push_back(fmt::format("{} shells; their union is solid", body.shells));
}

// Parameter, in units of `along`, at which a line from p crosses the triangle; none if it runs within its
// plane.
std::optional<double> line_triangle_intersection(const Vec3& p, const Vec3& along, const Vec3& a,
                                                 const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  const Vec3 across = along.cross(ac);
  const double determinant = ab.dot(across);
  if (determinant == 0) return std::nullopt;
  const Vec3 from = p - a;
  const Vec3 up = from.cross(ab);
  const double u = from.dot(across) / determinant, v = along.dot(up) / determinant;
  constexpr double margin = 1e-9;
  if (u < -margin || v < -margin || u + v > 1 + margin) return std::nullopt;
  return ac.dot(up) / determinant;
}

}  // namespace

Result<BodySurface> body_surface(const surface::TriangleMesh& mesh, const std::string& name,
                                 double thickness) {
  if (mesh.triangles.empty()) return fail(name, "has no triangles");
  BodySurface body;
  body.notes = mesh.notes;
  bounds(body, mesh.positions);
  weld_points(body, mesh);
  if (body.triangles.empty()) return fail(name, "has only triangles without area");
  const Shells shells = find_shells(body, find_edges(body));
  body.shells = int(shells.volume.size());
  orient_outwards(body, shells);
  count_edges(body);
  // Bounds of the points that triangles use.
  std::vector<Vec3> used;
  for (const Triangle& t : body.triangles) {
    for (const int p : t) used.push_back(body.points[std::size_t(p)]);
    body.area += 0.5 * (used.end()[-2] - used.end()[-3]).cross(used.end()[-1] - used.end()[-3]).norm();
  }
  bounds(body, used);
  if (thickness > 0) {
    body.thickness = thickness;
    body.volume = body.area * thickness;
    body.area *= 2;
    return body;
  }
  for (const Triangle& t : body.triangles)
    body.volume += signed_volume6(body, t, 0.5 * (body.low + body.high)) / 6;
  const double size = (body.high - body.low).maxCoeff();
  if (!(body.volume > 1e-9 * size * size * size) || !((body.high - body.low).minCoeff() > 0))
    return fail(name, "encloses no volume", "close the surface, or set a thickness");
  return body;
}

Result<SurfaceQuery> SurfaceQuery::make(const BodySurface& body, const std::string& name) {
  surface::TriangleMesh mesh;
  mesh.positions = body.points;
  mesh.triangles.assign(body.triangles.begin(), body.triangles.end());
  auto tree = surface::TriangleTree::make(mesh, name);
  if (!tree) return tl::unexpected(tree.error());
  return SurfaceQuery(body, std::move(*tree));
}

std::optional<SurfaceQuery::NearestPoint> SurfaceQuery::nearest_on_triangle(const Vec3& p,
                                                                            double reach) const {
  std::optional<NearestPoint> best;
  tree_.search(p, reach, [&](int t) {
    const Triangle& corner = body_->triangles[std::size_t(t)];
    const Vec3 &a = body_->points[std::size_t(corner[0])], &b = body_->points[std::size_t(corner[1])],
               &c = body_->points[std::size_t(corner[2])];
    const Vec3 w = nearest_barycentric(p, a, b, c);
    const Vec3 at = w[0] * a + w[1] * b + w[2] * c;
    if ((at - p).norm() < reach) {
      reach = (at - p).norm();
      best = {at, t, w};
    }
    return reach;
  });
  return best;
}

std::optional<Vec3> SurfaceQuery::nearest(const Vec3& p, double reach) const {
  const auto found = nearest_on_triangle(p, reach);
  return found ? std::optional(found->point) : std::nullopt;
}

double SurfaceQuery::distance(const Vec3& p, double reach) const {
  const auto found = nearest_on_triangle(p, reach);
  return found ? (found->point - p).norm() : reach;
}

std::optional<double> SurfaceQuery::single_crossing(const Vec3& a, const Vec3& b) const {
  const double radius = 0.5 * (b - a).norm();
  std::optional<double> only;
  bool is_ambiguous = false;
  tree_.search(0.5 * (a + b), radius, [&](int triangle) {
    const Triangle& corner = body_->triangles[std::size_t(triangle)];
    const auto t = line_triangle_intersection(a, b - a, body_->points[std::size_t(corner[0])],
                                              body_->points[std::size_t(corner[1])],
                                              body_->points[std::size_t(corner[2])]);
    if (!t || *t < 0 || *t > 1) return radius;
    if (only && std::abs(*t - *only) > same_place) is_ambiguous = true;
    // Deterministic choice among coincident crossings.
    if (!only || *t < *only) only = t;
    return radius;
  });
  return is_ambiguous ? std::nullopt : only;
}

}  // namespace intaglio::sound
