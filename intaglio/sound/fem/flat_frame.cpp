#include "intaglio/sound/fem/flat_frame.h"

#include <algorithm>
#include <cmath>

namespace intaglio::sound {

namespace {

constexpr std::size_t candidates = 200;
constexpr double least_share = 0.05;
constexpr double alike = 1 - 1e-4;  // cosine between normals of one flat face
constexpr double square = 1e-2;     // cosine between perpendicular ones

struct Facet {
  Vec3 normal;
  double area;
};

double area_along(const std::vector<Facet>& facets, const Vec3& axis) {
  double sum = 0;
  for (const Facet& f : facets) {
    if (std::abs(f.normal.dot(axis)) > alike) sum += f.area;
  }
  return sum;
}

}  // namespace

Mat3 flat_frame(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
  std::vector<Facet> facets;
  double total = 0;
  for (const Triangle& t : triangles) {
    const Vec3& o = points[std::size_t(t[0])];
    const Vec3 cross = (points[std::size_t(t[1])] - o).cross(points[std::size_t(t[2])] - o);
    if (cross.norm() > 0) facets.push_back({cross.normalized(), cross.norm()});
    total += cross.norm();
  }
  std::stable_sort(facets.begin(), facets.end(),
                   [](const Facet& a, const Facet& b) { return a.area > b.area; });
  // The coordinate axes come first, and win a tie.
  std::vector<Vec3> axes{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  for (std::size_t k = 0; k < std::min(candidates, facets.size()); ++k) axes.push_back(facets[k].normal);

  Mat3 frame = Mat3::Identity();
  double best = least_share * total;
  for (const Vec3& axis : axes) {
    const double area = area_along(facets, axis);
    if (!(area > 1.000001 * best)) continue;
    best = area;
    frame.col(0) = axis;
  }
  if (best == least_share * total) return Mat3::Identity();
  double second = -1;
  for (const Vec3& axis : axes) {
    if (std::abs(axis.dot(frame.col(0))) > square) continue;
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
