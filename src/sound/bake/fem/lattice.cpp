#include "sound/bake/fem/lattice.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "sound/bake/fem/tet_mesh.h"

namespace intaglio::sound {

namespace {

// A lattice point moves to a cut nearer than this fraction of the edge: Labelle & Shewchuk's values.
constexpr double long_snap = 0.24999, short_snap = 0.41189;
constexpr int bisections = 12;
constexpr double max_clearance_cells = 8;  // max clearance query, in cells

// Corners of the cells come first, then their middles; one cell of margin all round.
class Lattice {
 public:
  explicit Lattice(const LatticeBox& box)
      : n_{box.cells[0] + 2, box.cells[1] + 2, box.cells[2] + 2}, cell_(box.cell) {
    // Slightly offset, so that no point lies exactly on a face of the box.
    origin_ = box.low - cell_ + 1e-6 * cell_.cwiseProduct(Vec3(1, -2, 3));
    corners_ = (n_[0] + 1) * (n_[1] + 1) * (n_[2] + 1);
  }

  int size() const { return corners_ + n_[0] * n_[1] * n_[2]; }
  const Vec3& cell() const { return cell_; }
  bool is_middle(int v) const { return v >= corners_; }

  Vec3 position(int v) const {
    const bool middle = is_middle(v);
    const int nx = middle ? n_[0] : n_[0] + 1, ny = middle ? n_[1] : n_[1] + 1;
    if (middle) v -= corners_;
    const Vec3 at(v % nx, v / nx % ny, v / (nx * ny));
    return origin_ + cell_.cwiseProduct(middle ? Vec3(at + Vec3::Constant(0.5)) : at);
  }

  // Every tetrahedron: two middles of neighbouring cells and an edge of the face between them.
  template <class Visit>
  void each_tet(Visit visit) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t u = (axis + 1) % 3, w = (axis + 2) % 3;
      for (int cell = 0; cell < n_[0] * n_[1] * n_[2]; ++cell) {
        std::array<int, 3> at{cell % n_[0], cell / n_[0] % n_[1], cell / (n_[0] * n_[1])};
        const int near = middle(at);
        if (++at[axis] >= n_[axis]) continue;
        const int far = middle(at);
        std::array<int, 4> ring;
        for (std::size_t k = 0; k < 4; ++k) {
          std::array<int, 3> c = at;
          c[u] += k == 1 || k == 2;
          c[w] += k >= 2;
          ring[k] = corner(c);
        }
        for (std::size_t k = 0; k < 4; ++k) visit(std::array<int, 4>{near, far, ring[k], ring[(k + 1) % 4]});
      }
    }
  }

 private:
  int corner(const std::array<int, 3>& c) const { return c[0] + (n_[0] + 1) * (c[1] + (n_[1] + 1) * c[2]); }
  int middle(const std::array<int, 3>& c) const { return corners_ + c[0] + n_[0] * (c[1] + n_[1] * c[2]); }

  std::array<int, 3> n_;
  Vec3 cell_, origin_;
  int corners_;
};

struct Cut {
  int a, b;  // inside, outside
  double t;  // where the surface is, from a to b
};

class IsosurfaceStuffing {
 public:
  IsosurfaceStuffing(const Lattice& lattice, const SolidQuery& solid) : lattice_(lattice), solid_(solid) {}

  CornerMesh fill() {
    find_signs();
    lattice_.each_tet([&](const std::array<int, 4>& tet) { cut_edges(tet); });
    snap();
    for (const Cut& cut : cuts_)
      points_.emplace_back((1 - cut.t) * points_[std::size_t(cut.a)] + cut.t * points_[std::size_t(cut.b)]);
    lattice_.each_tet([&](const std::array<int, 4>& tet) { clip(tet); });
    return compact();
  }

 private:
  int sign(int v) const { return sign_[std::size_t(v)]; }
  static std::uint64_t key(int a, int b) { return std::uint64_t(a) << 32 | std::uint64_t(b); }

  // A point's clearance gives the sign of its neighbours in the row.
  void find_signs() {
    Vec3 from = Vec3::Zero();
    double clear = 0;
    for (int v = 0; v < lattice_.size(); ++v) {
      const Vec3& p = points_.emplace_back(lattice_.position(v));
      if ((p - from).norm() < clear) {
        sign_.push_back(sign_.back());
        continue;
      }
      sign_.push_back(solid_.inside(p) ? 1 : -1);
      from = p;
      clear = solid_.clearance ? solid_.clearance(p, max_clearance_cells * lattice_.cell().maxCoeff()) : 0;
    }
  }

  double crossing(const Vec3& inner, const Vec3& outer) const {
    if (const auto t = solid_.crossing ? solid_.crossing(inner, outer) : std::nullopt) return *t;
    double in = 0, out = 1;
    for (int k = 0; k < bisections; ++k) {
      const double t = 0.5 * (in + out);
      (solid_.inside((1 - t) * inner + t * outer) ? in : out) = t;
    }
    return 0.5 * (in + out);
  }

  void cut_edges(const std::array<int, 4>& tet) {
    for (const int a : tet) {
      for (const int b : tet) {
        if (sign(a) <= 0 || sign(b) >= 0) continue;
        if (!cut_of_.try_emplace(key(a, b), int(cuts_.size())).second) continue;
        cuts_.push_back({a, b, crossing(points_[std::size_t(a)], points_[std::size_t(b)])});
      }
    }
  }

  // Moves each point onto the nearest cut of its edges, if that is near enough; its other cuts vanish.
  void snap() {
    std::vector<std::vector<int>> cuts_of_point(sign_.size());
    for (std::size_t c = 0; c < cuts_.size(); ++c) {
      cuts_of_point[std::size_t(cuts_[c].a)].push_back(int(c));
      cuts_of_point[std::size_t(cuts_[c].b)].push_back(int(c));
    }
    for (int v = 0; v < lattice_.size(); ++v) {
      double nearest = 1e300;
      Vec3 to = Vec3::Zero();
      for (const int c : cuts_of_point[std::size_t(v)]) {
        const Cut& cut = cuts_[std::size_t(c)];
        const int other = cut.a == v ? cut.b : cut.a;
        if (sign(other) == 0) continue;
        const double t = cut.a == v ? cut.t : 1 - cut.t;
        const bool is_long = lattice_.is_middle(v) == lattice_.is_middle(other);
        const Vec3 edge = points_[std::size_t(other)] - points_[std::size_t(v)];
        if (t >= (is_long ? long_snap : short_snap) || t * edge.norm() >= nearest) continue;
        nearest = t * edge.norm();
        to = points_[std::size_t(v)] + t * edge;
      }
      if (nearest == 1e300) continue;
      points_[std::size_t(v)] = to;
      sign_[std::size_t(v)] = 0;
    }
  }

  int cut(int a, int b) const { return lattice_.size() + cut_of_.at(key(a, b)); }

  void clip(const std::array<int, 4>& tet) {
    std::vector<int>& p = positive_;
    std::vector<int>& n = negative_;
    std::vector<int>& z = zero_;
    p.clear(), n.clear(), z.clear();
    for (const int v : tet) (sign(v) > 0 ? p : sign(v) < 0 ? n : z).push_back(v);
    if (p.empty()) return;
    if (n.empty()) {
      mesh_.tets.push_back(tet);
    } else if (p.size() == 1) {
      std::array<int, 4> piece{p[0]};
      std::size_t k = 1;
      for (const int v : z) piece[k++] = v;
      for (const int v : n) piece[k++] = cut(p[0], v);
      mesh_.tets.push_back(piece);
    } else if (p.size() == 2 && z.size() == 1) {
      // A pyramid; its base is cut from its smallest index, as those of prisms are.
      const int a = std::min(p[0], p[1]), b = std::max(p[0], p[1]);
      const int a_cut = cut(a, n[0]), b_cut = cut(b, n[0]);
      mesh_.tets.insert(mesh_.tets.end(), {{a, b, b_cut, z[0]}, {a, b_cut, a_cut, z[0]}});
    } else {
      const auto prism =
          p.size() == 2
              ? std::array<int, 6>{p[0], cut(p[0], n[0]), cut(p[0], n[1]),
                                   p[1], cut(p[1], n[0]), cut(p[1], n[1])}
              : std::array<int, 6>{p[0], p[1], p[2], cut(p[0], n[0]), cut(p[1], n[0]), cut(p[2], n[0])};
      for (const auto& piece : prism_tets(prism)) mesh_.tets.push_back(piece);
    }
  }

  CornerMesh compact() {
    Renumbering number(points_.size());
    for (auto& tet : mesh_.tets) {
      for (int& v : tet) v = number(v, [&](std::size_t point) { mesh_.points.push_back(points_[point]); });
    }
    return std::move(mesh_);
  }

  const Lattice& lattice_;
  const SolidQuery& solid_;
  std::vector<Vec3> points_;
  std::vector<int> sign_;  // of lattice points: 1 inside, -1 outside, 0 moved onto the surface
  std::vector<Cut> cuts_;
  std::unordered_map<std::uint64_t, int> cut_of_;  // edge from inside to outside -> cut
  std::vector<int> positive_, negative_, zero_;
  CornerMesh mesh_;
};

}  // namespace

LatticeBox::LatticeBox(const Vec3& low_corner, const Vec3& high_corner, const Vec3& wanted)
    : low(low_corner), high(high_corner), cell(wanted), cells{1, 1, 1} {
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = Eigen::Index(k);
    const double extent = high[axis] - low[axis];
    cells[k] = int(std::clamp(std::round(extent / wanted[axis]), 1.0, 1e6));
    if (extent > 0) cell[axis] = extent / cells[k];
  }
}

double LatticeBox::points() const {
  return 2 * (cells[0] + 2.0) * (cells[1] + 2.0) * (cells[2] + 2.0);
}

CornerMesh fill_lattice(const LatticeBox& box, const SolidQuery& solid) {
  return IsosurfaceStuffing(Lattice(box), solid).fill();
}

namespace {

constexpr std::size_t max_candidates = 200;
constexpr double min_flat_share = 0.05;
constexpr double min_parallel_cosine = 1 - 1e-4;   // cosine between normals of one flat face
constexpr double max_perpendicular_cosine = 1e-2;  // cosine between perpendicular ones

struct Facet {
  Vec3 normal;
  double area;
};

double area_along(const std::vector<Facet>& facets, const Vec3& axis) {
  double sum = 0;
  for (const Facet& f : facets) {
    if (std::abs(f.normal.dot(axis)) > min_parallel_cosine) sum += f.area;
  }
  return sum;
}

}  // namespace

Mat3 flat_frame(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
  std::vector<Facet> facets;
  double total = 0;
  for (const Triangle& t : triangles) {
    const Vec3 cross = triangle_cross(points, t);
    if (cross.norm() > 0) facets.push_back({cross.normalized(), cross.norm()});
    total += cross.norm();
  }
  std::stable_sort(facets.begin(), facets.end(),
                   [](const Facet& a, const Facet& b) { return a.area > b.area; });
  // The coordinate axes come first, and win a tie.
  std::vector<Vec3> axes{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  for (std::size_t k = 0; k < std::min(max_candidates, facets.size()); ++k) axes.push_back(facets[k].normal);

  Mat3 frame = Mat3::Identity();
  double best = min_flat_share * total;
  for (const Vec3& axis : axes) {
    const double area = area_along(facets, axis);
    if (!(area > 1.000001 * best)) continue;
    best = area;
    frame.col(0) = axis;
  }
  if (best == min_flat_share * total) return Mat3::Identity();
  double second = -1;
  for (const Vec3& axis : axes) {
    if (std::abs(axis.dot(frame.col(0))) > max_perpendicular_cosine) continue;
    const double area = area_along(facets, axis);
    if (!(area > 1.000001 * second)) continue;
    second = area;
    frame.col(1) = axis;
  }
  if (second < 0) frame.col(1) = frame.col(0).unitOrthogonal();
  frame.col(1) = (frame.col(1) - frame.col(1).dot(frame.col(0)) * frame.col(0)).normalized();
  frame.col(2) = frame.col(0).cross(frame.col(1));
  return frame;
}

}  // namespace intaglio::sound
