#include "intaglio/sound/fem/thick_shell.h"

#include <algorithm>
#include <map>

namespace intaglio::sound {

namespace {

constexpr double on_edge = 1e-9;       // of a barycentric weight
constexpr double straight_out = 1e-6;  // sine: past the rim, a foot on it is met at a slant

}  // namespace

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

bool ThickShell::holds(const Vec3& p) const {
  const auto foot = surface_.foot(p, 0.5 * body_.thickness);
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
  const Vec3& o = body_.points[std::size_t(t[0])];
  const Vec3 normal =
      (body_.points[std::size_t(t[1])] - o).cross(body_.points[std::size_t(t[2])] - o).normalized();
  const Vec3 out = p - foot->point;
  return out.cross(normal).norm() <= straight_out * body_.thickness;
}

}  // namespace intaglio::sound
