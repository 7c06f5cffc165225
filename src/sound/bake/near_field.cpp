#include "sound/bake/near_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

namespace intaglio::sound {

namespace {

constexpr double near = 3;  // times a triangle's size: within it, integrals are exact
constexpr double whole = 4 * std::numbers::pi;

struct Element {
  std::array<Vec3, 3> corner, curl;  // curl of the linear function that is 1 at a corner
  Vec3 middle, normal;
  double area, size;
};

std::vector<Element> elements_of(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
  std::vector<Element> elements;
  for (const Triangle& t : triangles) {
    Element e;
    for (std::size_t k = 0; k < 3; ++k) e.corner[k] = points[std::size_t(t[k])];
    const Vec3 cross = (e.corner[1] - e.corner[0]).cross(e.corner[2] - e.corner[0]);
    e.area = 0.5 * cross.norm();
    e.normal = cross.normalized();
    e.middle = (e.corner[0] + e.corner[1] + e.corner[2]) / 3;
    e.size = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 opposite = e.corner[(k + 2) % 3] - e.corner[(k + 1) % 3];
      e.curl[k] = opposite / (2 * e.area);
      e.size = std::max(e.size, opposite.norm());
    }
    elements.push_back(e);
  }
  return elements;
}

// Mean over `at` of what `from` does there.
TrianglePotential mean_potential(const Element& at, const Element& from) {
  const Vec3 way = at.middle - from.middle;
  const double r = way.norm();
  if (r > near * std::max(at.size, from.size))
    return {from.area / r, from.area * way.dot(from.normal) / (r * r * r)};
  TrianglePotential sum;
  for (const Vec3& corner : at.corner) {
    // A rule of second degree: halfway to each corner.
    const TrianglePotential p =
        triangle_potential(0.5 * (at.middle + corner), from.corner[0], from.corner[1], from.corner[2]);
    sum.single += p.single / 3;
    sum.twice += p.twice / 3;
  }
  return sum;
}

}  // namespace

Eigen::MatrixXd near_potential(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                               const Eigen::MatrixXd& velocity) {
  const std::vector<Element> elements = elements_of(points, triangles);
  const auto count = Eigen::Index(elements.size()), corners = Eigen::Index(points.size());
  // twice(j, i): area of i times the mean over i of element j's double layer, over 4 pi. Signs: seen from
  // inside a body, its surface's solid angle is -4 pi.
  Eigen::MatrixXd twice(count, count);
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(corners, corners);
  Eigen::VectorXd of_single = Eigen::VectorXd::Zero(count);  // of each element, integral over all the surface
  for (Eigen::Index i = 0; i < count; ++i) {
    const Element& at = elements[std::size_t(i)];
    for (Eigen::Index j = 0; j < count; ++j) {
      const Element& from = elements[std::size_t(j)];
      const TrianglePotential p = mean_potential(at, from);
      const double single = at.area * p.single / whole;
      twice(j, i) = at.area * p.twice / whole;
      of_single[j] += single;
      for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t b = 0; b < 3; ++b)
          stiffness(triangles[std::size_t(i)][a], triangles[std::size_t(j)][b]) +=
              single * at.curl[a].dot(from.curl[b]);
      }
    }
  }
  stiffness = (0.5 * (stiffness + stiffness.transpose())).eval();
  // The constants that D leaves open, one for each part, are chosen later; points of no triangle stay 0.
  const std::vector<int> part = surface_parts(points.size(), triangles).of_point;
  const double scale = stiffness.diagonal().maxCoeff();
  for (Eigen::Index a = 0; a < corners; ++a) {
    for (Eigen::Index b = 0; b < corners; ++b) {
      if (part[std::size_t(a)] == part[std::size_t(b)]) stiffness(a, b) += 1e-2 * scale;
    }
    stiffness(a, a) *= 1 + 1e-9;
  }
  Eigen::VectorXd area(count);
  for (Eigen::Index j = 0; j < count; ++j) area[j] = elements[std::size_t(j)].area;
  const Eigen::MatrixXd load_of_elements = twice * velocity + 0.5 * (area.asDiagonal() * velocity);
  Eigen::MatrixXd load = Eigen::MatrixXd::Zero(corners, velocity.cols());
  for (Eigen::Index j = 0; j < count; ++j) {
    for (const int p : triangles[std::size_t(j)]) load.row(p) += load_of_elements.row(j) / 3;
  }
  const Eigen::MatrixXd at_corners = Eigen::LLT<Eigen::MatrixXd>(stiffness).solve(load);
  Eigen::MatrixXd potential(count, velocity.cols());
  for (Eigen::Index j = 0; j < count; ++j) {
    const Triangle& t = triangles[std::size_t(j)];
    potential.row(j) = (at_corners.row(t[0]) + at_corners.row(t[1]) + at_corners.row(t[2])) / 3;
  }
  // (1/2 - K) of a constant is that constant: the mean over the surface of (1/2 - K) Phi = V u.
  const Eigen::VectorXd of_double = 0.5 * area - twice.rowwise().sum();
  const Eigen::RowVectorXd mean =
      (of_single.transpose() * velocity - of_double.transpose() * potential) / area.sum();
  potential.rowwise() += mean;
  return potential;
}

TrianglePotential triangle_potential(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 cross = (b - a).cross(c - a);
  const double twice_area = cross.norm();
  if (!(twice_area > 0)) return {};
  const Vec3 n = cross / twice_area;
  const double height = (x - a).dot(n), h = std::abs(height);
  const Vec3 foot = x - height * n;
  const std::array<Vec3, 4> corner{a, b, c, a};
  double single = 0, angle = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 side = corner[k + 1] - corner[k];
    const double length = side.norm();
    if (!(length > 0)) return {};
    const Vec3 s = side / length;
    const double from = (corner[k] - foot).dot(s), to = from + length;
    const double out = (corner[k] - foot).dot(s.cross(n));  // how far outside the foot this side is
    const double from_edge = out * out + h * h;
    const double r_from = std::sqrt(from_edge + from * from), r_to = std::sqrt(from_edge + to * to);
    // Of the two forms that are equal the one without cancellation.
    const double ratio = from + to > 0 ? (r_to + to) / (r_from + from) : (r_from - from) / (r_to - to);
    if (out != 0 && ratio > 0 && std::isfinite(ratio)) single += out * std::log(ratio);
    if (h > 0)
      angle +=
          std::atan(out * to / (from_edge + h * r_to)) - std::atan(out * from / (from_edge + h * r_from));
  }
  return {single - h * angle, std::copysign(angle, height)};
}

namespace {

constexpr double least_area = 1e-9;  // of a triangle's longest side squared

}  // namespace

SurfaceParts surface_parts(std::size_t points, const std::vector<Triangle>& triangles) {
  std::vector<int> parent(points);
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int p) {
    while (parent[std::size_t(p)] != p)
      p = parent[std::size_t(p)] = parent[std::size_t(parent[std::size_t(p)])];
    return p;
  };
  for (const Triangle& t : triangles) {
    for (const int p : {t[1], t[2]}) parent[std::size_t(root(p))] = root(t[0]);
  }
  SurfaceParts parts{std::vector<int>(points, -1), 0};
  std::vector<int> number(points, -1);
  for (std::size_t p = 0; p < points; ++p) {
    int& of_root = number[std::size_t(root(int(p)))];
    if (of_root < 0) of_root = parts.count++;
    parts.of_point[p] = of_root;
  }
  return parts;
}

std::vector<Triangle> outside_of(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
  const SurfaceParts parts = surface_parts(points.size(), triangles);
  std::vector<double> volume(std::size_t(parts.count), 0.0);
  const auto at = [&](int p) { return points[std::size_t(p)]; };
  const auto part = [&](const Triangle& t) { return std::size_t(parts.of_point[std::size_t(t[0])]); };
  const Vec3 origin = points.empty() ? Vec3::Zero() : points.front();
  for (const Triangle& t : triangles)
    volume[part(t)] += (at(t[0]) - origin).dot((at(t[1]) - origin).cross(at(t[2]) - origin));
  std::vector<Triangle> outside;
  std::copy_if(triangles.begin(), triangles.end(), std::back_inserter(outside), [&](const Triangle& t) {
    const Vec3 a = at(t[1]) - at(t[0]), b = at(t[2]) - at(t[0]);
    const double side = std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
    return volume[part(t)] >= 0 && a.cross(b).norm() > least_area * side;
  });
  return outside;
}

}  // namespace intaglio::sound
