#include "intaglio/sound/triangle_potential.h"

#include <array>
#include <cmath>

namespace intaglio::sound {

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

}  // namespace intaglio::sound
