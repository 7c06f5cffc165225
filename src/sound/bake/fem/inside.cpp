#include "sound/bake/fem/inside.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

namespace intaglio::sound {

namespace {

constexpr int leaf_size = 8;
constexpr double far_field_radii = 3.5;  // distance in radii beyond which a branch is a dipole

// Signed solid angle of a triangle. Source: van Oosterom & Strackee, 1983.
double triangle_solid_angle(const Vec3& p, const std::array<Vec3, 3>& corners) {
  const Vec3 a = corners[0] - p, b = corners[1] - p, c = corners[2] - p;
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

constexpr double on_edge = 1e-9;         // of a barycentric weight
constexpr double max_slant_sine = 1e-6;  // beyond the rim the offset to the nearest point is oblique

}  // namespace

WindingNumber::WindingNumber(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
  std::vector<int> order(triangles.size());
  std::iota(order.begin(), order.end(), 0);
  build(order, points, triangles, 0, int(order.size()));
  for (const int t : order) {
    const Triangle& corners = triangles[std::size_t(t)];
    corners_.push_back(
        {points[std::size_t(corners[0])], points[std::size_t(corners[1])], points[std::size_t(corners[2])]});
  }
}

int WindingNumber::build(std::vector<int>& order, const std::vector<Vec3>& points,
                         const std::vector<Triangle>& triangles, int first, int end) {
  const auto corner = [&](int t, std::size_t k) -> const Vec3& {
    return points[std::size_t(triangles[std::size_t(t)][k])];
  };
  const auto middle_of = [&](int t) { return Vec3((corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3); };
  Branch branch{Vec3::Zero(), Vec3::Zero(), 0, first, end, 0};
  double area = 0;
  Vec3 low = Vec3::Constant(1e300), high = -low;
  for (int k = first; k < end; ++k) {
    const int t = order[std::size_t(k)];
    const Vec3 vector = 0.5 * (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0));
    const Vec3 middle = middle_of(t);
    branch.dipole += vector;
    branch.middle += vector.norm() * middle;
    area += vector.norm();
    low = low.cwiseMin(middle);
    high = high.cwiseMax(middle);
  }
  branch.middle = area > 0 ? Vec3(branch.middle / area) : Vec3(0.5 * (low + high));
  for (int k = first; k < end; ++k) {
    for (std::size_t c = 0; c < 3; ++c)
      branch.radius = std::max(branch.radius, (corner(order[std::size_t(k)], c) - branch.middle).norm());
  }
  const auto index = int(branches_.size());
  branches_.push_back(branch);
  if (end - first <= leaf_size) return index;
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const int half = (first + end) / 2;
  std::nth_element(order.begin() + first, order.begin() + half, order.begin() + end, [&](int a, int b) {
    const double x = middle_of(a)[axis], y = middle_of(b)[axis];
    return x != y ? x < y : a < b;
  });
  build(order, points, triangles, first, half);
  const int right = build(order, points, triangles, half, end);
  branches_[std::size_t(index)].right = right;
  return index;
}

double WindingNumber::value(const Vec3& p) const {
  return solid_angle(p, 0) / (4 * std::numbers::pi);
}

double WindingNumber::solid_angle(const Vec3& p, int index) const {
  const Branch& branch = branches_[std::size_t(index)];
  const Vec3 to = branch.middle - p;
  const double distance = to.norm();
  if (distance > far_field_radii * branch.radius)
    return to.dot(branch.dipole) / (distance * distance * distance);
  if (branch.right != 0) return solid_angle(p, index + 1) + solid_angle(p, branch.right);
  double sum = 0;
  for (int k = branch.first; k < branch.end; ++k) sum += triangle_solid_angle(p, corners_[std::size_t(k)]);
  return sum;
}

ThickShell::ThickShell(const BodySurface& body, const SurfaceQuery& surface)
    : body_(body), surface_(surface) {
  std::map<std::pair<int, int>, int> uses;
  for (const Triangle& t : body.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++uses[std::minmax(t[k], t[(k + 1) % 3])];
  }
  for (const auto& [edge, count] : uses) {
    if (count == 1) rim_.insert(edge);
  }
}

bool ThickShell::contains(const Vec3& p) const {
  const auto foot = surface_.nearest_on_triangle(p, 0.5 * body_.thickness);
  if (!foot) return false;
  if (rim_.empty()) return true;
  const Triangle& t = body_.triangles[std::size_t(foot->triangle)];
  const bool is_on_rim = [&] {
    for (std::size_t k = 0; k < 3; ++k) {
      if (foot->barycentric[Eigen::Index(k)] < on_edge &&
          rim_.contains(std::minmax(t[(k + 1) % 3], t[(k + 2) % 3])))
        return true;
    }
    return false;
  }();
  if (!is_on_rim) return true;
  const Vec3 normal = triangle_cross(body_.points, t).normalized();
  const Vec3 out = p - foot->point;
  return out.cross(normal).norm() <= max_slant_sine * body_.thickness;
}

}  // namespace intaglio::sound
