#include "intaglio/render/mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace intaglio::render {

Mesh lathe(std::span<const ProfilePoint> profile, int slices) {
  Mesh mesh;
  const auto columns = static_cast<std::uint32_t>(profile.size());
  for (int slice = 0; slice <= slices; ++slice) {
    const double angle = 2 * std::numbers::pi * slice / slices;
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    for (const ProfilePoint& p : profile) {
      mesh.vertices.push_back({{float(p.radius * c), float(p.radius * s), float(p.z)},
                               {float(p.normal_radius * c), float(p.normal_radius * s), float(p.normal_z)}});
    }
  }
  for (std::uint32_t slice = 0; slice < static_cast<std::uint32_t>(slices); ++slice) {
    for (std::uint32_t k = 0; k + 1 < columns; ++k) {
      const std::uint32_t here = slice * columns + k;
      const std::uint32_t next = here + columns;
      for (const std::uint32_t corner : {here, next, next + 1, here, next + 1, here + 1})
        mesh.indices.push_back(corner);
    }
  }
  return mesh;
}

Mesh unit_sphere(int slices) {
  std::vector<ProfilePoint> half_circle;
  const int stacks = slices / 2;
  for (int k = 0; k <= stacks; ++k) {
    const double angle = std::numbers::pi * (double(k) / stacks - 0.5);
    half_circle.push_back({std::cos(angle), std::sin(angle), std::cos(angle), std::sin(angle)});
  }
  return lathe(half_circle, slices);
}

Mesh pen(double length, double radius, int slices) {
  const double cone = std::min(pen_tip_radii * radius, length);
  const double slope = 1 / std::hypot(radius, cone);  // the cone's normal is (cone, -radius) * slope
  const std::array<ProfilePoint, 6> profile = {{{0, 0, cone * slope, -radius * slope},
                                                {radius, cone, cone * slope, -radius * slope},
                                                {radius, cone, 1, 0},
                                                {radius, length, 1, 0},
                                                {radius, length, 0, 1},
                                                {0, length, 0, 1}}};
  return lathe(profile, slices);
}

}  // namespace intaglio::render
