#include "sound/bake/fem/sharp_edges.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

namespace intaglio::sound {

namespace {

constexpr double sharp_cosine = 0.866;   // of the angle between normals: 30 degrees
constexpr double corner_cosine = 0.766;  // of the bend of an edge: 40 degrees
// Twice the area over the longest side squared: thinner triangles have no reliable normal.
constexpr double min_triangle_quality = 1e-4;

}  // namespace

std::vector<SharpEdge> find_sharp_edges(const BodySurface& body) {
  // Zero if the triangle is too thin to have one.
  const auto normal = [&](std::size_t t) {
    const auto& [a, b, c] = body.triangles[t];
    const Vec3& o = body.points[std::size_t(a)];
    const Vec3 p = body.points[std::size_t(b)] - o, q = body.points[std::size_t(c)] - o, n = p.cross(q);
    const double longest = std::max({p.squaredNorm(), q.squaredNorm(), (p - q).squaredNorm()});
    return n.norm() > min_triangle_quality * longest ? Vec3(n.normalized()) : Vec3(Vec3::Zero());
  };
  struct Side {
    std::pair<int, int> edge;
    std::size_t triangle;
    bool operator<(const Side& other) const {
      return std::tie(edge, triangle) < std::tie(other.edge, other.triangle);
    }
  };
  std::vector<Side> sides;
  sides.reserve(3 * body.triangles.size());
  for (std::size_t t = 0; t < body.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k)
      sides.push_back({std::minmax({body.triangles[t][k], body.triangles[t][(k + 1) % 3]}), t});
  }
  std::sort(sides.begin(), sides.end());
  std::vector<SharpEdge> sharp;
  for (std::size_t k = 0, next = 0; k < sides.size(); k = next) {
    for (next = k; next < sides.size() && sides[next].edge == sides[k].edge;) ++next;
    if (next - k != 2) continue;  // if more meet, their neighbours are ambiguous
    const Vec3 left = normal(sides[k].triangle), right = normal(sides[k + 1].triangle);
    if (left.isZero(0) || right.isZero(0) || left.dot(right) >= sharp_cosine) continue;
    sharp.push_back({sides[k].edge.first, sides[k].edge.second, left, right});
  }
  return sharp;
}

double total_length(const std::vector<SharpEdge>& edges, const BodySurface& body) {
  double length = 0;
  for (const SharpEdge& e : edges)
    length += (body.points[std::size_t(e.from)] - body.points[std::size_t(e.to)]).norm();
  return length;
}

SharpEdges::SharpEdges(const BodySurface& body, const std::vector<SharpEdge>& edges, double reach)
    : cell_(1.5 * reach) {
  for (const SharpEdge& edge : edges) {
    const Vec3 &from = body.points[std::size_t(edge.from)], &to = body.points[std::size_t(edge.to)];
    const int index = int(segments_.size());
    segments_.push_back({from, to});
    // Samples at most half a cell apart, since queries search the neighbouring cells.
    const int steps = 1 + int((to - from).norm() / (0.5 * cell_));
    for (int k = 0; k <= steps; ++k) {
      std::vector<int>& list = in_cell_[cell_of(from + double(k) / steps * (to - from))];
      if (list.empty() || list.back() != index) list.push_back(index);
    }
  }
  find_corners(body, edges);
}

SharpEdges::Cell SharpEdges::cell_of(const Vec3& p) const {
  return {std::llround(p.x() / cell_), std::llround(p.y() / cell_), std::llround(p.z() / cell_)};
}

void SharpEdges::find_corners(const BodySurface& body, const std::vector<SharpEdge>& edges) {
  std::map<int, std::vector<Vec3>> directions;  // from each point along its sharp edges
  for (const SharpEdge& e : edges) {
    const Vec3 along = (body.points[std::size_t(e.to)] - body.points[std::size_t(e.from)]).normalized();
    directions[e.from].push_back(along);
    directions[e.to].emplace_back(-along);
  }
  for (const auto& [point, along] : directions) {
    if (along.size() > 2 || (along.size() == 2 && along[0].dot(along[1]) > -corner_cosine))
      corners_.push_back(body.points[std::size_t(point)]);
  }
}

std::optional<Vec3> SharpEdges::nearest(const Vec3& p, double within) const {
  std::optional<Vec3> best;
  const Cell middle = cell_of(p);
  for (int k = 0; k < 27; ++k) {
    const auto found =
        in_cell_.find({middle[0] + k % 3 - 1, middle[1] + k / 3 % 3 - 1, middle[2] + k / 9 - 1});
    if (found == in_cell_.end()) continue;
    for (const int s : found->second) {
      const auto& [a, b] = segments_[std::size_t(s)];
      const Vec3 along = b - a;
      const Vec3 foot = a + std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0) * along;
      if (!((foot - p).norm() < within)) continue;
      within = (foot - p).norm();
      best = foot;
    }
  }
  return best;
}

namespace {

using Tet = std::array<int, 4>;

// In cells: reach of snapping to corners and edges, and of splitting.
constexpr double corner_reach = 0.8, edge_reach = 0.5, cut_reach = 0.75;
constexpr double min_cut_depth = 0.06;  // distance of an edge's middle from the surface, over its length
constexpr double min_quality = 0.05, min_quality_split = 0.03;
constexpr int split_rounds = 10;

// Quality of a tetrahedron: 1 if regular, 0 if flat, negative if inverted.
double quality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const double squares = (b - a).squaredNorm() + (c - a).squaredNorm() + (d - a).squaredNorm() +
                         (c - b).squaredNorm() + (d - b).squaredNorm() + (d - c).squaredNorm();
  return std::sqrt(2.0) * (b - a).cross(c - a).dot(d - a) / std::pow(squares / 6, 1.5);
}

class EdgeRecovery {
 public:
  EdgeRecovery(CornerMesh& mesh, const SharpEdges& edges, const SurfaceQuery& surface, double cell)
      : mesh_(mesh), edges_(edges), surface_(surface), cell_(cell), is_kept_(mesh.points.size(), false) {
    for (Tet& t : mesh_.tets) {
      if (quality_of(t) < 0) std::swap(t[2], t[3]);
    }
    find_boundary();
  }

  void run() {
    move_to_corners();
    move_to_edges();
    for (int round = 0; round < split_rounds && split_cuts() > 0; ++round) find_boundary();
  }

 private:
  const Vec3& at(int v) const { return mesh_.points[std::size_t(v)]; }
  double quality_of(const Tet& t) const { return quality(at(t[0]), at(t[1]), at(t[2]), at(t[3])); }

  void find_boundary() {
    tets_of_.assign(mesh_.points.size(), {});
    std::map<std::array<int, 3>, int> uses;
    for (std::size_t t = 0; t < mesh_.tets.size(); ++t) {
      for (std::size_t leave = 0; leave < 4; ++leave) {
        tets_of_[std::size_t(mesh_.tets[t][leave])].push_back(int(t));
        std::array<int, 3> face{};
        for (std::size_t k = 0; k < 3; ++k) face[k] = mesh_.tets[t][(leave + 1 + k) % 4];
        std::sort(face.begin(), face.end());
        ++uses[face];
      }
    }
    boundary_points_.clear();
    boundary_edges_.clear();
    for (const auto& [face, count] : uses) {
      if (count != 1) continue;
      boundary_points_.insert(face.begin(), face.end());
      boundary_edges_.insert({{face[0], face[1]}, {face[1], face[2]}, {face[0], face[2]}});
    }
  }

  bool move(int v, const Vec3& to) {
    const Vec3 from = at(v);
    const auto worst = [&] {
      double least = 1;
      for (const int t : tets_of_[std::size_t(v)])
        least = std::min(least, quality_of(mesh_.tets[std::size_t(t)]));
      return least;
    };
    const double before = worst();
    mesh_.points[std::size_t(v)] = to;
    if (worst() > std::min(min_quality, 0.9 * before)) {
      is_kept_[std::size_t(v)] = true;
      return true;
    }
    mesh_.points[std::size_t(v)] = from;
    return false;
  }

  void move_to_corners() {
    for (const Vec3& corner : edges_.corners()) {
      std::vector<std::pair<double, int>> near;
      for (const int v : boundary_points_) {
        const double distance = (at(v) - corner).norm();
        if (distance < corner_reach * cell_ && !is_kept_[std::size_t(v)]) near.emplace_back(distance, v);
      }
      std::sort(near.begin(), near.end());
      for (const auto& candidate : near) {
        if (move(candidate.second, corner)) break;
      }
    }
  }

  void move_to_edges() {
    std::vector<std::pair<double, int>> near;
    for (const int v : boundary_points_) {
      if (is_kept_[std::size_t(v)]) continue;
      if (const auto foot = edges_.nearest(at(v), edge_reach * cell_))
        near.emplace_back((*foot - at(v)).norm(), v);
    }
    std::sort(near.begin(), near.end());
    for (const auto& candidate : near) move(candidate.second, *edges_.nearest(at(candidate.second), cell_));
  }

  // Point of the sharp edge that element edge (a, b) cuts off.
  std::optional<Vec3> sharp_edge_crossing(int a, int b) const {
    const Vec3 middle = 0.5 * (at(a) + at(b)), along = at(b) - at(a);
    const double length = along.norm(), off = min_cut_depth * length;
    if (surface_.nearest(middle, off)) return std::nullopt;
    const auto foot = edges_.nearest(middle, std::min(cut_reach * cell_, 0.6 * length));
    if (!foot) return std::nullopt;
    const double place = (*foot - at(a)).dot(along) / (length * length);
    return place > 0.05 && place < 0.95 ? foot : std::nullopt;
  }

  int split_cuts() {
    std::vector<std::pair<double, std::pair<int, int>>> cuts;
    for (const auto& [a, b] : boundary_edges_) {
      if (sharp_edge_crossing(a, b)) cuts.push_back({-(at(a) - at(b)).norm(), {a, b}});
    }
    std::sort(cuts.begin(), cuts.end());
    std::vector<bool> is_new(mesh_.tets.size(), false);
    int split = 0;
    for (const auto& cut : cuts) split += split_edge(cut.second.first, cut.second.second, is_new);
    return split;
  }

  // At the sharp edge, or as near to it as elements allow.
  bool split_edge(int a, int b, std::vector<bool>& is_new) {
    std::vector<int> around;
    for (const int t : tets_of_[std::size_t(a)]) {
      if (is_new[std::size_t(t)]) return false;  // already split in this round; handled in the next
      const Tet& tet = mesh_.tets[std::size_t(t)];
      if (std::find(tet.begin(), tet.end(), b) != tet.end()) around.push_back(t);
    }
    const Vec3 middle = 0.5 * (at(a) + at(b)), foot = *sharp_edge_crossing(a, b);
    for (const double share : {1.0, 0.75, 0.5}) {
      if (split_at(middle + share * (foot - middle), a, b, around, is_new)) return true;
    }
    return false;
  }

  bool split_at(const Vec3& place, int a, int b, const std::vector<int>& around, std::vector<bool>& is_new) {
    const int middle = int(mesh_.points.size());
    mesh_.points.push_back(place);
    std::vector<std::pair<Tet, Tet>> halves;
    for (const int t : around) {
      Tet first = mesh_.tets[std::size_t(t)], second = first;
      std::replace(first.begin(), first.end(), b, middle);
      std::replace(second.begin(), second.end(), a, middle);
      if (!(std::min(quality_of(first), quality_of(second)) > min_quality_split)) {
        mesh_.points.pop_back();
        return false;
      }
      halves.emplace_back(first, second);
    }
    for (std::size_t k = 0; k < around.size(); ++k) {
      mesh_.tets[std::size_t(around[k])] = halves[k].first;
      mesh_.tets.push_back(halves[k].second);
      is_new[std::size_t(around[k])] = true;
    }
    is_kept_.push_back(true);
    return true;
  }

  CornerMesh& mesh_;
  const SharpEdges& edges_;
  const SurfaceQuery& surface_;
  double cell_;
  std::vector<bool> is_kept_;  // of each point: it has been moved to a sharp edge or a corner
  std::vector<std::vector<int>> tets_of_;
  std::set<int> boundary_points_;
  std::set<std::pair<int, int>> boundary_edges_;
};

}  // namespace

void keep_edges(CornerMesh& mesh, const SharpEdges& edges, const SurfaceQuery& surface, double cell) {
  EdgeRecovery(mesh, edges, surface, cell).run();
}

}  // namespace intaglio::sound
