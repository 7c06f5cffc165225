#include "sound/bake/fem/body_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <fmt/format.h>

namespace intaglio::sound {

namespace {

constexpr double weld = 1e-7;  // of the bounding box's diagonal

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
  const double cell = weld * (body.high - body.low).norm();
  std::map<std::array<std::int64_t, 3>, int> at;
  std::vector<int> number;
  for (const Vec3& p : mesh.positions) {
    const Vec3 q = (p - body.low) / cell;
    const auto [found, is_new] =
        at.try_emplace({std::llround(q.x()), std::llround(q.y()), std::llround(q.z())},
                       static_cast<int>(body.points.size()));
    if (is_new) body.points.push_back(p);
    number.push_back(found->second);
  }
  for (const auto& t : mesh.triangles) {
    const Triangle welded{number[std::size_t(t[0])], number[std::size_t(t[1])], number[std::size_t(t[2])]};
    if (welded[0] != welded[1] && welded[1] != welded[2] && welded[2] != welded[0])
      body.triangles.push_back(welded);
  }
  if (const auto dropped = mesh.triangles.size() - body.triangles.size(); dropped > 0)
    body.notes.push_back(fmt::format("{} triangles shrank to a line and were dropped", dropped));
}

using Edges = std::map<std::pair<int, int>, std::vector<EdgeUse>>;

Edges edges_of(const BodySurface& body) {
  Edges edges;
  for (std::size_t t = 0; t < body.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = body.triangles[t][k], b = body.triangles[t][(k + 1) % 3];
      edges[std::minmax(a, b)].push_back({static_cast<int>(t), a < b});
    }
  }
  return edges;
}

bool is_balanced(const std::vector<EdgeUse>& uses) {
  const auto forward =
      std::count_if(uses.begin(), uses.end(), [](const EdgeUse& use) { return use.forward; });
  return 2 * forward == static_cast<std::ptrdiff_t>(uses.size());
}

// Six times the volume between a triangle and a point.
double cone(const BodySurface& body, const Triangle& t, const Vec3& apex) {
  const auto at = [&](std::size_t k) { return Vec3(body.points[std::size_t(t[k])] - apex); };
  return at(0).dot(at(1).cross(at(2)));
}

struct Shells {
  std::vector<int> of;       // of each triangle
  std::vector<bool> turned;  // of each triangle: it winds against the first of its shell
  std::vector<double> volume;
  std::vector<int> turns;  // triangles turned in each
  std::vector<Vec3> low, high;
};

Shells find_shells(const BodySurface& body, const Edges& edges) {
  std::vector<std::vector<std::pair<int, bool>>> beside(body.triangles.size());  // neighbour, winds alike
  const auto join = [&](int a, int b, bool alike) {
    beside[std::size_t(a)].emplace_back(b, alike);
    beside[std::size_t(b)].emplace_back(a, alike);
  };
  for (const auto& [edge, uses] : edges) {
    if (uses.size() == 2) {
      join(uses[0].triangle, uses[1].triangle, uses[0].forward != uses[1].forward);
    } else if (is_balanced(uses)) {
      // More than two, and as many each way: they are wound as they should be.
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
  shells.of.assign(body.triangles.size(), -1);
  shells.turned.assign(body.triangles.size(), false);
  for (std::size_t seed = 0; seed < body.triangles.size(); ++seed) {
    if (shells.of[seed] >= 0) continue;
    const auto shell = static_cast<int>(shells.volume.size());
    std::vector<std::size_t> members{seed};
    shells.of[seed] = shell;
    int turns = 0;
    double volume = 0;
    Vec3 low = Vec3::Constant(1e300), high = -low;
    for (std::size_t k = 0; k < members.size(); ++k) {
      const std::size_t t = members[k];
      turns += shells.turned[t];
      volume += (shells.turned[t] ? -1 : 1) * cone(body, body.triangles[t], 0.5 * (body.low + body.high)) / 6;
      for (const int p : body.triangles[t]) {
        low = low.cwiseMin(body.points[std::size_t(p)]);
        high = high.cwiseMax(body.points[std::size_t(p)]);
      }
      for (const auto& [next, alike] : beside[t]) {
        if (shells.of[std::size_t(next)] >= 0) continue;
        shells.of[std::size_t(next)] = shell;
        shells.turned[std::size_t(next)] = alike ? shells.turned[t] : !shells.turned[t];
        members.push_back(std::size_t(next));
      }
    }
    shells.volume.push_back(volume);
    shells.turns.push_back(turns);
    shells.low.push_back(low);
    shells.high.push_back(high);
  }
  return shells;
}

// A shell whose windings agreed may face inwards for a reason: it is the wall of a hollow in another one.
bool is_hollow(const Shells& shells, std::size_t shell) {
  if (shells.turns[shell] != 0) return false;
  for (std::size_t other = 0; other < shells.volume.size(); ++other) {
    if (other != shell && shells.volume[other] > -shells.volume[shell] &&
        (shells.low[other].array() < shells.low[shell].array()).all() &&
        (shells.high[other].array() > shells.high[shell].array()).all())
      return true;
  }
  return false;
}

void turn_outwards(BodySurface& body, const Shells& shells) {
  std::vector<bool> inwards(shells.volume.size());
  for (std::size_t s = 0; s < inwards.size(); ++s) inwards[s] = shells.volume[s] < 0 && !is_hollow(shells, s);
  int turned = 0;
  for (std::size_t t = 0; t < body.triangles.size(); ++t) {
    if (shells.turned[t] == inwards[std::size_t(shells.of[t])]) continue;
    std::swap(body.triangles[t][1], body.triangles[t][2]);
    ++turned;
  }
  if (turned > 0)
    body.notes.push_back(
        fmt::format("{} of {} triangles faced inwards and were turned", turned, body.triangles.size()));
}

void count_edges(BodySurface& body) {
  int crowded = 0;
  for (const auto& [edge, uses] : edges_of(body)) {
    body.open_edges += !is_balanced(uses);
    crowded += uses.size() > 2;
  }
  if (body.open_edges > 0)
    body.notes.push_back(
        fmt::format("{} edges are open; winding numbers decide what is inside", body.open_edges));
  if (crowded > 0) body.notes.push_back(fmt::format("{} edges have more than two triangles", crowded));
  if (body.shells > 1)
    body.notes.push_back(fmt::format("it has {} shells; what any of them encloses is solid", body.shells));
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
  const Shells shells = find_shells(body, edges_of(body));
  body.shells = static_cast<int>(shells.volume.size());
  turn_outwards(body, shells);
  count_edges(body);
  // Only what triangles use counts, and the flat directions too.
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
  for (const Triangle& t : body.triangles) body.volume += cone(body, t, 0.5 * (body.low + body.high)) / 6;
  const double size = (body.high - body.low).maxCoeff();
  if (!(body.volume > 1e-9 * size * size * size) || !((body.high - body.low).minCoeff() > 0))
    return fail(name, "encloses no volume",
                "a body that rings is solid: close the surface, or give it thickness");
  return body;
}

namespace {

constexpr double same_place = 1e-6;  // of the line: triangles that meet there are met as one

// Where, in units of `along`, a line from p meets the triangle; not when it runs within its plane.
std::optional<double> meeting(const Vec3& p, const Vec3& along, const Vec3& a, const Vec3& b, const Vec3& c) {
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

Result<SurfaceQuery> SurfaceQuery::make(const BodySurface& body, const std::string& name) {
  surface::TriangleMesh mesh;
  mesh.positions = body.points;
  mesh.triangles.assign(body.triangles.begin(), body.triangles.end());
  auto tree = surface::TriangleTree::make(mesh, name);
  if (!tree) return tl::unexpected(tree.error());
  return SurfaceQuery(body, std::move(*tree));
}

std::optional<SurfaceQuery::Foot> SurfaceQuery::foot(const Vec3& p, double reach) const {
  std::optional<Foot> best;
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
  const auto found = foot(p, reach);
  return found ? std::optional(found->point) : std::nullopt;
}

double SurfaceQuery::distance(const Vec3& p, double reach) const {
  const auto found = foot(p, reach);
  return found ? (found->point - p).norm() : reach;
}

std::optional<double> SurfaceQuery::only_crossing(const Vec3& a, const Vec3& b) const {
  const double radius = 0.5 * (b - a).norm();
  std::optional<double> only;
  bool several = false;
  tree_.search(0.5 * (a + b), radius, [&](int triangle) {
    const Triangle& corner = body_->triangles[std::size_t(triangle)];
    const auto t = meeting(a, b - a, body_->points[std::size_t(corner[0])],
                           body_->points[std::size_t(corner[1])], body_->points[std::size_t(corner[2])]);
    if (!t || *t < 0 || *t > 1) return radius;
    if (only && std::abs(*t - *only) > same_place) several = true;
    // Of those at one place always the same, whatever order they come in.
    if (!only || *t < *only) only = t;
    return radius;
  });
  return several ? std::nullopt : only;
}

}  // namespace intaglio::sound
