// The peer of bench/haptics.cpp: a finger proxy on the triangles of a relief, as libraries of haptics do it.
//
// Zilles and Salisbury's god object as a point. Each tick the proxy moves towards the tip; the first triangle
// in its way becomes a constraint and the goal is projected onto it, then onto the edge of two, until three
// hold or nothing is in the way. Triangles are found by walking the grid under the segment, which is faster
// than the trees of general meshes. The force is K (proxy - tip).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "surface/surface.h"

namespace intaglio::bench {

class TriangleProxy {
 public:
  struct State {
    Vec3 proxy = Vec3::Zero();  // local
    bool started = false;
  };

  explicit TriangleProxy(const surface::Surface& surface) : surface_(surface) {}

  std::size_t triangle_count() const {
    return 2 * std::size_t(surface_.width()) * std::size_t(surface_.height());
  }

  // Force on the hand at the tip x (world), N.
  Vec3 move(State& state, const Vec3& x, double stiffness) const {
    const Vec3 tip = surface_.placement().to_local(x);
    if (!state.started) state = {{tip.x(), tip.y(), 0.001}, true};
    std::array<Vec3, 3> planes;
    std::size_t held = 0;
    Vec3 goal = tip;
    for (int step = 0; step < 10; ++step) {
      const Hit hit = first_hit(state.proxy, goal);
      if (!hit.found) {
        state.proxy = goal;
        break;
      }
      // To just above the triangle.
      state.proxy += hit.t * (goal - state.proxy);
      state.proxy += clearance * hit.normal;
      if (held == planes.size()) break;
      planes[held++] = hit.normal;
      goal = projected(tip, state.proxy, planes, held);
    }
    return stiffness * surface_.placement().direction_to_world(state.proxy - tip);
  }

 private:
  static constexpr double clearance = 1e-6;  // m

  struct Hit {
    bool found = false;
    double t = 2;
    Vec3 normal = Vec3::UnitZ();
  };

  // The point nearest to the tip that the planes through the proxy allow.
  static Vec3 projected(const Vec3& tip, const Vec3& proxy, const std::array<Vec3, 3>& planes,
                        std::size_t held) {
    const Vec3 wish = tip - proxy;
    if (held == 1) return proxy + wish - wish.dot(planes[0]) * planes[0];
    if (held == 2) {
      const Vec3 edge = planes[0].cross(planes[1]);
      const double square = edge.squaredNorm();
      return square < 1e-12 ? proxy : Vec3(proxy + wish.dot(edge) / square * edge);
    }
    return proxy;
  }

  static void meet(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& from, const Vec3& along,
                   Hit& hit) {
    const Vec3 e = b - a, f = c - a, n = e.cross(f);
    const double facing = along.dot(n);
    if (facing >= 0) return;  // from behind
    const Vec3 s = from - a;
    const double t = -s.dot(n) / facing;
    if (t < 0 || t > 1 || t >= hit.t) return;
    const Vec3 q = s.cross(along);
    const double u = -f.dot(q) / facing, v = e.dot(q) / facing;
    constexpr double slack = -1e-9;
    if (u < slack || v < slack || u + v > 1 - slack) return;
    hit = {true, t, n.normalized()};
  }

  Hit first_hit(const Vec3& from, const Vec3& to) const {
    Hit hit;
    const Vec3 along = to - from;
    const auto [i0, j0] = surface_.cell_at(std::min(from.x(), to.x()), std::min(from.y(), to.y()));
    const auto [i1, j1] = surface_.cell_at(std::max(from.x(), to.x()), std::max(from.y(), to.y()));
    for (int j = j0; j <= j1; ++j) {
      for (int i = i0; i <= i1; ++i) {
        const surface::Cell cell = surface_.cell(i, j);
        const Vec3 a = cell.at(0, 0), b = cell.at(1, 0), c = cell.at(1, 1), d = cell.at(0, 1);
        meet(a, b, c, from, along, hit);
        meet(a, c, d, from, along, hit);
      }
    }
    return hit;
  }

  const surface::Surface& surface_;
};

}  // namespace intaglio::bench
