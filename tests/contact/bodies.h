// Shapes and poses for the tests of contact.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "contact/surface_contacts.h"
#include "core/portable_math.h"

namespace intaglio::tests {

inline Quat any_turn(Random& random) {
  return Quat(random.normal(), random.normal(), random.normal(), random.normal()).normalized();
}

inline std::vector<Vec3> points_on_ellipsoid(int count, const Vec3& half, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3> points;
  for (int k = 0; k < count; ++k)
    points.push_back(Vec3(random.normal(), random.normal(), random.normal()).normalized().cwiseProduct(half));
  return points;
}

// A thick L along X and Y, closed, with an inner edge.
inline contact::Mesh angle_bracket(double size) {
  const double t = 0.4 * size;
  const std::vector<Vec2> outline = {{0, 0}, {size, 0}, {size, t}, {t, t}, {t, size}, {0, size}};
  std::vector<Vec3> vertices;
  for (const double z : {-0.5 * t, 0.5 * t}) {
    for (const Vec2& p : outline) vertices.emplace_back(p.x() - t, p.y() - t, z);
  }
  std::vector<std::array<int, 3>> triangles;
  for (const auto& [a, b, c] :
       {std::array{0, 1, 2}, std::array{0, 2, 3}, std::array{0, 3, 4}, std::array{0, 4, 5}}) {
    triangles.push_back({a + 6, b + 6, c + 6});
    triangles.push_back({a, c, b});
  }
  for (int k = 0; k < 6; ++k) {
    const int next = (k + 1) % 6;
    triangles.push_back({k, next, next + 6});
    triangles.push_back({k, next + 6, k + 6});
  }
  return {*contact::closed_mesh(vertices, triangles)};
}

// The distance of the first contact, or `otherwise` where there is none.
inline double first_distance(const contact::ContactSet& set, double otherwise) {
  return set.count > 0 ? set.points[0].distance : otherwise;
}

struct Body {
  std::string name;
  contact::Shape shape;
};

// One of each shape, some `size` metres across.
inline std::vector<Body> bodies(double size) {
  using namespace contact;
  const double s = 0.5 * size;
  std::vector<Body> out = {
      {"sphere", Sphere{s}},
      {"capsule", Capsule{0.5 * s, s}},
      {"box", Box{Vec3(s, 0.6 * s, 0.8 * s)}},
      {"cylinder", Cylinder{0.7 * s, 0.5 * s}},
      {"hull", ConvexHull{*convex_hull(points_on_ellipsoid(32, Vec3(s, 0.7 * s, 0.9 * s), 5))}},
      {"mesh", angle_bracket(size)},
  };
  out.push_back({"compound", make_compound({{Sphere{0.5 * s}, {Vec3(s, 0, 0), Quat::Identity()}},
                                            {Box{Vec3::Constant(0.4 * s)},
                                             {Vec3(-s, 0, 0), Quat(0.9, 0.1, 0.3, 0.2).normalized()}}})});
  return out;
}

inline Body body(const std::string& name, double size) {
  for (const Body& b : bodies(size)) {
    if (b.name == name) return b;
  }
  std::abort();
}

}  // namespace intaglio::tests
