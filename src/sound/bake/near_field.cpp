#include "sound/bake/near_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sound/bake/fem/tet_mesh.h"

namespace intaglio::sound {

namespace {

// The exterior Neumann problem, G = 1 / (4 pi r), normals n into the air, u = -dPhi/dn:
//
// Green's formula gives Phi outside as the double layer of Phi plus the single layer of u. On the surface,
// where the double layer jumps by 1/2, that is
//
//   (1/2 - K) Phi = V u        V f = integral of G f,  K f = integral of dG/dn_y f                  (1)
//
// and its derivative -d/dn_x is, with D = -d/dn_x K and the jump -1/2 of d/dn_x V,
//
//   D Phi = (1/2 + K') u       K' = transpose of K                                                  (2)
//
// (2) is solved. Maue's form needs no hypersingular integral:
//
//   <D Phi, Psi> = double integral of G curl Phi . curl Psi,   curl f = n x grad f, constant on a triangle.
//
// Constants on a connected part have no curl, so D has one null vector per part; (2) is solvable all the
// same, as (1/2 + K) 1 = 0 makes its right side orthogonal to them. Adding a positive multiple of 1 1^T on
// the block of each part makes the matrix positive definite and changes nothing else: it selects the
// solution whose corner values add up to 0 on each part.
//
// The constant that is missing follows from (1): (1/2 - K) 1 = 1 on a closed surface, so it is the mean over
// the surface of V u - (1/2 - K) Phi. With several parts only their common mean is found in this way; their
// means relative to each other stay as the solution of (2) has them.

constexpr double near_field_sizes = 3;     // in element sizes: exact integrals within this distance
constexpr double constant_penalty = 1e-2;  // multiple of 1 1^T over the largest diagonal entry
constexpr double diagonal_shift = 1e-9;    // relative: keeps rounding from making the factorisation fail
constexpr double four_pi = 4 * std::numbers::pi;
constexpr double min_area = 1e-9;  // of a triangle's longest side squared

struct Element {
  std::array<Vec3, 3> corner, curl;  // curl of the linear function that is 1 at a corner
  Vec3 middle, normal;
  double area, size;
};

std::vector<Element> make_elements(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
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

// Mean potential of element `source` over element `target`.
TrianglePotential mean_potential(const Element& target, const Element& source) {
  const Vec3 way = target.middle - source.middle;
  const double r = way.norm();
  if (r > near_field_sizes * std::max(target.size, source.size))
    return {source.area / r, source.area * way.dot(source.normal) / (r * r * r)};
  TrianglePotential sum;
  for (const Vec3& corner : target.corner) {
    // A rule of second degree: halfway to each corner.
    const TrianglePotential p = triangle_potential(0.5 * (target.middle + corner), source.corner[0],
                                                   source.corner[1], source.corner[2]);
    sum.single_layer += p.single_layer / 3;
    sum.double_layer += p.double_layer / 3;
  }
  return sum;
}

}  // namespace

Eigen::MatrixXd incompressible_potential(const std::vector<Vec3>& points,
                                         const std::vector<Triangle>& triangles,
                                         const Eigen::MatrixXd& velocity) {
  const std::vector<Element> elements = make_elements(points, triangles);
  const auto count = Eigen::Index(elements.size()), corners = Eigen::Index(points.size());
  // double_layer(j, i): <1_i, K 1_j>. Signs: seen from inside a body, its surface's solid angle is -4 pi.
  Eigen::MatrixXd double_layer(count, count);
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(corners, corners);
  Eigen::VectorXd single_layer_sum = Eigen::VectorXd::Zero(count);  // integral of V 1_j over the surface
  for (Eigen::Index i = 0; i < count; ++i) {
    const Element& target = elements[std::size_t(i)];
    for (Eigen::Index j = 0; j < count; ++j) {
      const Element& source = elements[std::size_t(j)];
      const TrianglePotential p = mean_potential(target, source);
      const double single_layer = target.area * p.single_layer / four_pi;
      double_layer(j, i) = target.area * p.double_layer / four_pi;
      single_layer_sum[j] += single_layer;
      for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t b = 0; b < 3; ++b)
          stiffness(triangles[std::size_t(i)][a], triangles[std::size_t(j)][b]) +=
              single_layer * target.curl[a].dot(source.curl[b]);
      }
    }
  }
  stiffness = (0.5 * (stiffness + stiffness.transpose())).eval();
  // An unreferenced point is a part of its own, and stays 0.
  const std::vector<int> part = surface_parts(points.size(), triangles).part_of_point;
  const double scale = stiffness.diagonal().maxCoeff();
  for (Eigen::Index a = 0; a < corners; ++a) {
    for (Eigen::Index b = 0; b < corners; ++b) {
      if (part[std::size_t(a)] == part[std::size_t(b)]) stiffness(a, b) += constant_penalty * scale;
    }
    stiffness(a, a) *= 1 + diagonal_shift;
  }
  Eigen::VectorXd area(count);
  for (Eigen::Index j = 0; j < count; ++j) area[j] = elements[std::size_t(j)].area;
  const Eigen::MatrixXd element_load = double_layer * velocity + 0.5 * (area.asDiagonal() * velocity);
  Eigen::MatrixXd load = Eigen::MatrixXd::Zero(corners, velocity.cols());
  for (Eigen::Index j = 0; j < count; ++j) {
    for (const int p : triangles[std::size_t(j)]) load.row(p) += element_load.row(j) / 3;
  }
  const Eigen::MatrixXd corner_potential = Eigen::LLT<Eigen::MatrixXd>(stiffness).solve(load);
  Eigen::MatrixXd potential(count, velocity.cols());
  for (Eigen::Index j = 0; j < count; ++j) {
    const Triangle& t = triangles[std::size_t(j)];
    potential.row(j) =
        (corner_potential.row(t[0]) + corner_potential.row(t[1]) + corner_potential.row(t[2])) / 3;
  }
  // Integrals over the surface of (1/2 - K) 1_j; those of V 1_j are above.
  const Eigen::VectorXd double_layer_residual = 0.5 * area - double_layer.rowwise().sum();
  const Eigen::RowVectorXd mean =
      (single_layer_sum.transpose() * velocity - double_layer_residual.transpose() * potential) / area.sum();
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
  double single_layer = 0, angle = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 side = corner[k + 1] - corner[k];
    const double length = side.norm();
    if (!(length > 0)) return {};
    const Vec3 s = side / length;
    const double from = (corner[k] - foot).dot(s), to = from + length;
    const double out = (corner[k] - foot).dot(s.cross(n));  // how far outside the foot this side is
    const double from_edge = out * out + h * h;
    const double r_from = std::sqrt(from_edge + from * from), r_to = std::sqrt(from_edge + to * to);
    // Chooses the form without cancellation.
    const double ratio = from + to > 0 ? (r_to + to) / (r_from + from) : (r_from - from) / (r_to - to);
    if (out != 0 && ratio > 0 && std::isfinite(ratio)) single_layer += out * std::log(ratio);
    if (h > 0)
      angle +=
          std::atan(out * to / (from_edge + h * r_to)) - std::atan(out * from / (from_edge + h * r_from));
  }
  return {single_layer - h * angle, std::copysign(angle, height)};
}

SurfaceParts surface_parts(std::size_t points, const std::vector<Triangle>& triangles) {
  DisjointSets sets(points);
  for (const Triangle& t : triangles) {
    for (const int p : {t[1], t[2]}) sets.join(std::size_t(p), std::size_t(t[0]));
  }
  SurfaceParts parts{std::vector<int>(points, -1), 0};
  Renumbering number(points);
  for (std::size_t p = 0; p < points; ++p)
    parts.part_of_point[p] = number(int(sets.root(p)), [](std::size_t) {});
  parts.count = number.used();
  return parts;
}

std::vector<Triangle> outer_triangles(const std::vector<Vec3>& points,
                                      const std::vector<Triangle>& triangles) {
  const SurfaceParts parts = surface_parts(points.size(), triangles);
  std::vector<double> volume(std::size_t(parts.count), 0.0);
  const auto at = [&](int p) { return points[std::size_t(p)]; };
  const auto part = [&](const Triangle& t) { return std::size_t(parts.part_of_point[std::size_t(t[0])]); };
  const Vec3 origin = points.empty() ? Vec3::Zero() : points.front();
  for (const Triangle& t : triangles)
    volume[part(t)] += (at(t[0]) - origin).dot((at(t[1]) - origin).cross(at(t[2]) - origin));
  std::vector<Triangle> outside;
  std::copy_if(triangles.begin(), triangles.end(), std::back_inserter(outside), [&](const Triangle& t) {
    const Vec3 a = at(t[1]) - at(t[0]), b = at(t[2]) - at(t[0]);
    const double side = std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
    return volume[part(t)] >= 0 && a.cross(b).norm() > min_area * side;
  });
  return outside;
}

}  // namespace intaglio::sound
