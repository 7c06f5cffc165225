#include "intaglio/sound/near_field.h"

#include <array>
#include <cmath>
#include <numbers>

#include "intaglio/sound/surface_parts.h"
#include "intaglio/sound/triangle_potential.h"

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

}  // namespace intaglio::sound
