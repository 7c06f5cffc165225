#include "intaglio/sound/surface_parts.h"

#include <algorithm>
#include <numeric>

namespace intaglio::sound {

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
