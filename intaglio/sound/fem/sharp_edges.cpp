#include "intaglio/sound/fem/sharp_edges.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace intaglio::sound {

namespace {

constexpr double sharp_cosine = 0.866;   // of the angle between normals: 30 degrees
constexpr double corner_cosine = 0.766;  // of the turn of an edge: 40 degrees
constexpr double thinnest = 1e-4;        // triangle, over the square of its longest side: others face nowhere

}  // namespace

std::vector<SharpEdge> sharp_edges_of(const BodySurface& body) {
  // Zero of one that is too thin to have any.
  const auto normal = [&](std::size_t t) {
    const auto& [a, b, c] = body.triangles[t];
    const Vec3& o = body.points[std::size_t(a)];
    const Vec3 p = body.points[std::size_t(b)] - o, q = body.points[std::size_t(c)] - o, n = p.cross(q);
    const double longest = std::max({p.squaredNorm(), q.squaredNorm(), (p - q).squaredNorm()});
    return n.norm() > thinnest * longest ? Vec3(n.normalized()) : Vec3(Vec3::Zero());
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
    if (next - k != 2) continue;  // where more meet, which of them are neighbours is not known
    const Vec3 left = normal(sides[k].triangle), right = normal(sides[k + 1].triangle);
    if (left.isZero(0) || right.isZero(0) || left.dot(right) >= sharp_cosine) continue;
    sharp.push_back({sides[k].edge.first, sides[k].edge.second, left, right});
  }
  return sharp;
}

double length_of(const std::vector<SharpEdge>& edges, const BodySurface& body) {
  double length = 0;
  for (const SharpEdge& e : edges)
    length += (body.points[std::size_t(e.from)] - body.points[std::size_t(e.to)]).norm();
  return length;
}

SharpEdges::SharpEdges(const BodySurface& body, const std::vector<SharpEdge>& edges, double reach)
    : cell_(1.5 * reach) {
  for (const SharpEdge& edge : edges) {
    const Vec3 &from = body.points[std::size_t(edge.from)], &to = body.points[std::size_t(edge.to)];
    const int index = static_cast<int>(segments_.size());
    segments_.push_back({from, to});
    // Some place of the segment within a quarter of a cell of any other: a query looks one cell around.
    const int steps = 1 + static_cast<int>((to - from).norm() / (0.5 * cell_));
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
  std::map<int, std::vector<Vec3>> ways;  // from each point along its sharp edges
  for (const SharpEdge& e : edges) {
    const Vec3 along = (body.points[std::size_t(e.to)] - body.points[std::size_t(e.from)]).normalized();
    ways[e.from].push_back(along);
    ways[e.to].emplace_back(-along);
  }
  for (const auto& [point, along] : ways) {
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

}  // namespace intaglio::sound
