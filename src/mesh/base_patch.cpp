#include "mesh/base_patch.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace intaglio::surface {

namespace {

// In weights: neighbours overlap by so much, so that no point falls between them.
constexpr double base_tolerance = 1e-9;

// A triangle that is moved along its normals to where they meet shrinks to a point, where weights are noise.
// It counts as folded when its area is below this fraction of that on the base.
constexpr double min_jacobian_ratio = 1e-6;

// The normal of the moved triangle, a + b s + c s^2.
struct OffsetNormal {
  Vec3 a, b, c;

  explicit OffsetNormal(const BasePatch& patch) {
    const Vec3 e1 = patch.p[1] - patch.p[0];
    const Vec3 e2 = patch.p[2] - patch.p[0];
    const Vec3 m1 = patch.n[1] - patch.n[0];
    const Vec3 m2 = patch.n[2] - patch.n[0];
    a = e1.cross(e2);
    b = e1.cross(m2) + m1.cross(e2);
    c = m1.cross(m2);
  }
  Vec3 at(double s) const { return a + s * (b + s * c); }
};

// c0 + c1 s + c2 s^2 + c3 s^3.
struct Cubic {
  double c0, c1, c2, c3;
  double operator()(double s) const { return c0 + s * (c1 + s * (c2 + s * c3)); }
  double slope(double s) const { return c1 + s * (2 * c2 + s * 3 * c3); }
};

// Real roots of a + b s + c s^2, ascending; stable when c is nearly zero.
int quadratic_roots(double a, double b, double c, std::array<double, 2>& roots) {
  const double discriminant = b * b - 4 * a * c;
  if (!(discriminant >= 0)) return 0;
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  int count = 0;
  if (c != 0 && std::isfinite(q / c)) roots[std::size_t(count++)] = q / c;
  if (q != 0 && std::isfinite(a / q)) roots[std::size_t(count++)] = a / q;
  if (count == 2 && roots[0] > roots[1]) std::swap(roots[0], roots[1]);
  return count;
}

// The root between low and high, where the cubic has one sign change and no turning point: Newton, kept
// inside by bisection.
double bracketed_root(const Cubic& cubic, double low, double high) {
  const bool rising = cubic(low) < 0;
  double s = low <= 0 && high >= 0 ? 0 : 0.5 * (low + high);
  for (int iteration = 0; iteration < 80; ++iteration) {
    const double value = cubic(s);
    if (value == 0) return s;
    ((value < 0) == rising ? low : high) = s;
    double next = s - value / cubic.slope(s);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - s) <= 1e-16 * std::abs(s) || next == s) return next;
    s = next;
  }
  return s;
}

// Roots of the cubic in [-limit, limit].
int roots_within(const Cubic& cubic, double limit, std::array<double, 3>& roots) {
  std::array<double, 4> ends{-limit};
  std::size_t count_ends = 1;
  std::array<double, 2> turning{};
  const int turns = quadratic_roots(cubic.c1, 2 * cubic.c2, 3 * cubic.c3, turning);
  for (std::size_t k = 0; k < std::size_t(turns); ++k) {
    if (std::abs(turning[k]) < limit) ends[count_ends++] = turning[k];
  }
  ends[count_ends] = limit;
  int count = 0;
  for (std::size_t k = 0; k < count_ends; ++k) {
    const double at_low = cubic(ends[k]);
    const double at_high = cubic(ends[k + 1]);
    if (at_low == 0)
      roots[std::size_t(count++)] = ends[k];
    else if (at_low * at_high < 0 || (at_high == 0 && k + 1 == count_ends))
      roots[std::size_t(count++)] = at_high == 0 ? limit : bracketed_root(cubic, ends[k], ends[k + 1]);
  }
  return count;
}

// A lower bound of the length of the interpolated normal N: |N| >= N . m >= min n_k . m for any unit m, since
// N is a convex combination of the n_k. With m along their sum it is exact for equally spread normals.
double min_normal_length(const BasePatch& patch) {
  const Vec3 sum = patch.n[0] + patch.n[1] + patch.n[2];
  const double length = sum.norm();
  if (length < 1e-9) return 0;
  return std::max(0.0, std::min({patch.n[0].dot(sum), patch.n[1].dot(sum), patch.n[2].dot(sum)}) / length);
}

Vec3 weights_in(const BasePatch& patch, double s, const Vec3& normal, const Vec3& point) {
  const Vec3 q0 = patch.p[0] + s * patch.n[0];
  const Vec3 f1 = patch.p[1] + s * patch.n[1] - q0;
  const Vec3 f2 = patch.p[2] + s * patch.n[2] - q0;
  const Vec3 offset = point - q0;
  const double area2 = normal.squaredNorm();
  const double w1 = offset.cross(f2).dot(normal) / area2;
  const double w2 = f1.cross(offset).dot(normal) / area2;
  return {1 - w1 - w2, w1, w2};
}

}  // namespace

BasePatch patch_of(const TriangleMesh& mesh, int triangle) {
  const auto [a, b, c] = mesh.triangles[std::size_t(triangle)];
  const auto i = std::size_t(a), j = std::size_t(b), k = std::size_t(c);
  return {{mesh.positions[i], mesh.positions[j], mesh.positions[k]},
          {mesh.normals[i], mesh.normals[j], mesh.normals[k]}};
}

std::optional<Projection> project(const BasePatch& patch, const Vec3& point, double reach) {
  const OffsetNormal moved(patch);
  const Vec3 offset = point - patch.p[0];
  const Vec3& n0 = patch.n[0];
  const Cubic cubic{offset.dot(moved.a), offset.dot(moved.b) - n0.dot(moved.a),
                    offset.dot(moved.c) - n0.dot(moved.b), -n0.dot(moved.c)};
  // A root beyond this limit is out of reach, by the lower bound of |N|. Normals that spread further than 87
  // degrees lose some reach.
  const double limit = reach / std::max(min_normal_length(patch), 0.05) * (1 + 1e-12);
  std::array<double, 3> roots{};
  const int count = roots_within(cubic, limit, roots);
  std::optional<Projection> nearest;
  for (std::size_t k = 0; k < std::size_t(count); ++k) {
    const Vec3 normal = moved.at(roots[k]);
    const Vec3 weights = weights_in(patch, roots[k], normal, point);
    if (!(weights.minCoeff() >= -base_tolerance)) continue;
    const Vec3 direction = weights[0] * patch.n[0] + weights[1] * patch.n[1] + weights[2] * patch.n[2];
    const double on_base = moved.a.dot(direction);
    if (!(on_base > 0 && normal.dot(direction) > min_jacobian_ratio * on_base))
      continue;  // at a fold, or beyond
    const double height = roots[k] * direction.norm();
    if (std::abs(height) > reach || (nearest && std::abs(nearest->height) <= std::abs(height))) continue;
    nearest = Projection{weights, height};
  }
  return nearest;
}

PatchBounds::PatchBounds(const BasePatch& patch)
    : middle((patch.p[0] + patch.p[1] + patch.p[2]) / 3),
      radius(0),
      axis(patch.normal(Vec3::Constant(1.0 / 3))),
      sine(0) {
  for (std::size_t k = 0; k < 3; ++k) {
    radius = std::max(radius, (patch.p[k] - middle).norm() * (1 + 10 * base_tolerance));
    sine = patch.n[k].dot(axis) > 0
               ? std::max(sine, patch.n[k].cross(axis).norm() * (1 + 10 * base_tolerance))
               : 1;
  }
}

bool PatchBounds::may_reach(const Vec3& point, double reach) const {
  const Vec3 offset = point - middle;
  const double length2 = offset.squaredNorm();
  const double along = offset.dot(axis);
  const double half_width = radius + std::min(reach, std::sqrt(length2) + radius) * sine;
  // The difference loses digits: hence the last term.
  return length2 - along * along <= half_width * half_width + 1e-12 * length2;
}

double triangle_distance(const BasePatch& patch, const Vec3& point) {
  const Vec3 normal = (patch.p[1] - patch.p[0]).cross(patch.p[2] - patch.p[0]);
  bool over = true;
  double nearest2 = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 edge = patch.p[(k + 1) % 3] - patch.p[k];
    const Vec3 offset = point - patch.p[k];
    if (normal.cross(edge).dot(offset) >= 0) continue;
    over = false;
    nearest2 =
        std::min(nearest2,
                 (offset - std::clamp(offset.dot(edge) / edge.squaredNorm(), 0.0, 1.0) * edge).squaredNorm());
  }
  return over ? std::abs(normal.dot(point - patch.p[0])) / normal.norm() : std::sqrt(nearest2);
}

double fold_depth(const BasePatch& patch) {
  const OffsetNormal moved(patch);
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& n : patch.n) {
    const double facing = n.dot(moved.a);
    if (facing <= 0) return 0;
    std::array<double, 2> depths{};
    const int count = quadratic_roots(facing, -n.dot(moved.b), n.dot(moved.c), depths);
    for (std::size_t k = 0; k < std::size_t(count); ++k) {
      if (depths[k] > 0) least = std::min(least, depths[k]);
    }
  }
  return least * min_normal_length(patch);
}

}  // namespace intaglio::surface
