// Closed paths of a tip on a texture, and the work that a method of contact does on the hand along them.
#pragma once

#include <functional>
#include <numbers>
#include <vector>

#include "core/portable_math.h"
#include "haptics/held_plane.h"
#include "haptics/proxy.h"

namespace intaglio::tests {

// A closed path, either a pressed slide, a lift, a return in the air and a press, or a loop that wanders in
// and out of the surface. Steps of at most `step` metres; frame of the surface's placement.
inline std::vector<Vec3> closed_loop(const surface::Surface& s, Random& random, double step) {
  const surface::Placement& place = s.placement();
  const auto on = [&](double x, double y, double above) -> Vec3 {
    return {x, y, s.smooth({x / place.size_u(), y / place.size_v()}).height + above};
  };
  const double x = random.uniform(0.2, 0.8) * place.size_u(), y = random.uniform(0.2, 0.8) * place.size_v();
  const double angle = random.uniform(0, 6.283), reach = 0.005;
  const double x2 = x + reach * std::cos(angle), y2 = y + reach * std::sin(angle);
  std::vector<Vec3> corners;
  if (random.uniform() < 0.5) {
    const double press = -random.uniform(0.5e-3, 3e-3), lift = 3e-3;
    corners = {on(x, y, press), on(x2, y2, press), on(x2, y2, lift), on(x, y, lift)};
  } else {
    const double phase = random.uniform(0, 6.283);
    for (int k = 0; k < 40; ++k) {
      const double t = k * std::numbers::pi / 20;
      corners.push_back(on(x + 0.5 * reach * std::cos(t), y + 0.5 * reach * std::sin(2 * t + phase), 0));
      corners.back().z() = -0.5 * s.max_depth() + 2e-3 * std::sin(3 * t + angle);
    }
  }
  std::vector<Vec3> path;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec3& from = corners[k];
    const Vec3 along = corners[(k + 1) % corners.size()] - from;
    const int steps = 1 + int(along.norm() / step);
    for (int n = 0; n < steps; ++n) path.push_back(place.to_world(from + along * n / steps));
  }
  path.push_back(path.front());
  return path;
}

// The same path with each step divided into `times`.
inline std::vector<Vec3> refined(const std::vector<Vec3>& path, int times) {
  std::vector<Vec3> out;
  for (std::size_t k = 1; k < path.size(); ++k) {
    for (int n = 0; n < times; ++n) out.push_back(path[k - 1] + (path[k] - path[k - 1]) * n / times);
  }
  out.push_back(path.back());
  return out;
}

// Work on the hand, J, of one round of `path` at `speed`. `force(x, v, dt)` may have state: the second of two
// rounds counts.
inline double work_round(const std::vector<Vec3>& path, double speed,
                         const std::function<Vec3(const Vec3&, const Vec3&, double)>& force) {
  double work = 0;
  for (int round = 0; round < 2; ++round) {
    work = 0;
    Vec3 before = force(path[0], Vec3::Zero(), 1e-9);
    for (std::size_t k = 1; k < path.size(); ++k) {
      const Vec3 dx = path[k] - path[k - 1];
      const double dt = std::max(dx.norm() / speed, 1e-9);
      const Vec3 f = force(path[k], dx / dt, dt);
      work += 0.5 * (before + f).dot(dx);
      before = f;
    }
  }
  return work;
}

}  // namespace intaglio::tests
