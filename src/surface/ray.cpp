#include "surface/ray.h"

#include <algorithm>
#include <cmath>

namespace intaglio::surface {

namespace {

// An interval of the ray; empty when from > to.
struct RayInterval {
  double from, to;

  // Clipped to where origin + t direction is within [low, high].
  RayInterval clipped(double origin, double direction, double low, double high) const {
    if (direction == 0) return origin >= low && origin <= high ? *this : RayInterval{1, 0};
    double a = (low - origin) / direction;
    double b = (high - origin) / direction;
    if (a > b) std::swap(a, b);
    return {std::max(from, a), std::min(to, b)};
  }
  bool empty() const { return !(from <= to); }
};

// Smallest t in the interval at which the ray is on the patch.
//
// Along the ray the patch coordinates are s = s0 + s1 t and r = r0 + r1 t, and the height above the patch is
//   o_z + d_z t - (z0 + a s + b r + twist s r) = A t^2 + B t + C.
// Its roots are q / A and C / q with q = -(B + sign(B) sqrt(B^2 - 4 A C)) / 2, which does not cancel. t is in
// metres along the largest axis, so 1e-12 (1 + t) is far below a texel; where |A| is below 1e-14 |B| the
// quadratic term is rounding noise.
std::optional<double> hit_patch(const Cell& cell, const Vec3& o, const Vec3& d, const RayInterval& within) {
  const double s0 = (o.x() - cell.x0) / cell.width();
  const double s1 = d.x() / cell.width();
  const double r0 = (o.y() - cell.y0) / cell.height();
  const double r1 = d.y() / cell.height();
  const double a = cell.z[1] - cell.z[0];
  const double b = cell.z[2] - cell.z[0];
  const double twist = cell.twist();
  const double A = -twist * s1 * r1;
  const double B = d.z() - a * s1 - b * r1 - twist * (s0 * r1 + s1 * r0);
  const double C = o.z() - cell.z[0] - a * s0 - b * r0 - twist * s0 * r0;
  const double tolerance = 1e-12 * (1 + std::abs(within.to));
  std::optional<double> best;
  const auto consider = [&](double t) {
    if (t >= within.from - tolerance && t <= within.to + tolerance && (!best || t < *best)) best = t;
  };
  if (std::abs(A) < 1e-14 * std::max(std::abs(B), 1e-300)) {
    if (B != 0) consider(-C / B);
    return best;
  }
  const double discriminant = B * B - 4 * A * C;
  if (discriminant < 0) return best;
  const double q = -0.5 * (B + std::copysign(std::sqrt(discriminant), B));
  consider(q / A);
  if (q != 0) consider(C / q);
  return best;
}

// Front-to-back traversal of the pyramid. t is in metres along the largest axis, from where the ray enters
// the relief's box.
class Traversal {
 public:
  Traversal(const Surface& surface, const Vec3& origin, const Vec3& direction, double length)
      : surface_(surface), pyramid_(surface.pyramid()), o_(origin), d_(direction), t_end_(length) {}

  std::optional<RayHit> run() {
    visit_tile(0, 0);
    if (surface_.edge() == Edge::wrap) {
      // The half texel at the low borders belongs to the previous tile's cells.
      visit_tile(-1, 0);
      visit_tile(0, -1);
      visit_tile(-1, -1);
    }
    return hit_;
  }

 private:
  void visit_tile(int a, int b) {
    shift_i_ = a * surface_.width() + pyramid_.first_cell();
    shift_j_ = b * surface_.height() + pyramid_.first_cell();
    visit(pyramid_.levels() - 1, 0, 0, clip_to_cells(pyramid_.columns(), pyramid_.rows(), 0, 0));
  }
  double line_x(int i) const {
    return (shift_i_ + std::min(i, pyramid_.columns()) + 0.5) * surface_.texel_u();
  }
  double line_y(int j) const { return (shift_j_ + std::min(j, pyramid_.rows()) + 0.5) * surface_.texel_v(); }
  // The part of the ray over cells [i, i + columns) x [j, j + rows), up to the hit found so far.
  RayInterval clip_to_cells(int columns, int rows, int i, int j) const {
    return RayInterval{0, t_end_}
        .clipped(o_.x(), d_.x(), line_x(i), line_x(i + columns))
        .clipped(o_.y(), d_.y(), line_y(j), line_y(j + rows));
  }
  bool visit(int level, int x, int y, const RayInterval& outer);
  bool visit_leaf(int x, int y);
  bool visit_cell(int i, int j);

  const Surface& surface_;
  const Pyramid& pyramid_;
  Vec3 o_, d_;
  double t_end_;  // of the ray, or of the first hit
  std::optional<RayHit> hit_;
  int shift_i_ = 0, shift_j_ = 0;
};

// The n-th of 2 x 2 children in an order in which the ray enters none before an earlier one.
int front_to_back(int n, const Vec3& direction) {
  return n ^ (direction.x() < 0 ? 1 : 0) ^ (direction.y() < 0 ? 2 : 0);
}

// True when there was a hit: the first one of this tile.
bool Traversal::visit(int level, int x, int y, const RayInterval& outer) {
  if (outer.empty()) return false;
  const int side = Pyramid::block_cells(level);
  const Pyramid::Bounds4 quad = pyramid_.quad(level, x, y);
  const double margin = 1e-9 * surface_.max_depth() + 1e-12;
  for (int n = 0; n < 4; ++n) {
    const int k = front_to_back(n, d_), cx = 2 * x + (k & 1), cy = 2 * y + (k >> 1);
    const double low = -surface_.max_depth() * quad.deep[std::size_t(k)],
                 high = -surface_.max_depth() * quad.shallow[std::size_t(k)];
    if (!(low <= high)) continue;
    const RayInterval inner = clip_to_cells(side, side, cx * side, cy * side);
    if (inner.empty()) continue;
    if (inner.clipped(o_.z(), d_.z(), low - margin, high + margin).empty()) continue;
    if (level > 0 ? visit(level - 1, cx, cy, inner) : visit_leaf(cx, cy)) return true;
  }
  return false;
}

// Visits the cells of a block in the order in which the ray crosses them, by the same rule.
bool Traversal::visit_leaf(int x, int y) {
  for (int outer = 0; outer < 4; ++outer) {
    for (int inner = 0; inner < 4; ++inner) {
      const int a = front_to_back(outer, d_), b = front_to_back(inner, d_);
      const int i = x * Pyramid::leaf_cells + 2 * (a & 1) + (b & 1),
                j = y * Pyramid::leaf_cells + 2 * (a >> 1) + (b >> 1);
      if (i < pyramid_.columns() && j < pyramid_.rows() && visit_cell(i, j)) return true;
    }
  }
  return false;
}

bool Traversal::visit_cell(int i, int j) {
  const RayInterval within = clip_to_cells(1, 1, i, j);
  if (within.empty()) return false;
  const Cell cell = surface_.cell(shift_i_ + i, shift_j_ + j);
  const auto t = hit_patch(cell, o_, d_, within);
  if (!t) return false;
  const Vec3 point = o_ + *t * d_;
  t_end_ = *t;
  hit_ = RayHit{*t, point,
                cell.normal((point.x() - cell.x0) / cell.width(), (point.y() - cell.y0) / cell.height())};
  return true;
}

// The box that the ray was clipped to is slightly thicker than the plane, so the hit of a nearly horizontal
// ray may be 1e-12 m off the plane.
std::optional<RayHit> hit_plane(const Vec3& origin, const Vec3& direction, double length) {
  if (direction.z() == 0) {
    if (origin.z() != 0) return std::nullopt;
    return RayHit{0, origin, Vec3::UnitZ()};
  }
  const double t = std::clamp(-origin.z() / direction.z(), 0.0, length);
  return RayHit{t, origin + t * direction, Vec3::UnitZ()};
}

}  // namespace

std::optional<RayHit> intersect(const Surface& surface, const Vec3& origin, const Vec3& direction,
                                double t_min, double t_max) {
  const double largest = direction.cwiseAbs().maxCoeff();
  if (!origin.allFinite() || !direction.allFinite() || largest == 0) return std::nullopt;
  const Placement& place = surface.placement();
  const double margin = 1e-9 * surface.max_depth() + 1e-12;
  const RayInterval box = RayInterval{t_min, t_max}
                              .clipped(origin.x(), direction.x(), 0, place.size_u())
                              .clipped(origin.y(), direction.y(), 0, place.size_v())
                              .clipped(origin.z(), direction.z(),
                                       -(surface.is_flat() ? 0 : surface.max_depth()) - margin, margin);
  if (box.empty()) return std::nullopt;
  const Vec3 enter = origin + box.from * direction;
  const Vec3 d = direction / largest;
  const double length = (box.to - box.from) * largest;
  auto hit = surface.is_flat() ? hit_plane(enter, d, length) : Traversal(surface, enter, d, length).run();
  if (!hit) return std::nullopt;
  hit->t = std::clamp(box.from + hit->t / largest, t_min, t_max);
  return hit;
}

}  // namespace intaglio::surface
