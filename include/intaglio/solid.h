// Convex hulls and closed meshes as shapes; volume, centre of mass and inertia of any shape. Pure functions,
// any thread.
//
//   auto hull = intaglio::make_hull(points);
//   if (!hull) { std::cerr << hull.error() << '\n'; return 1; }
//   world.add(*hull, {.material = "stone"});                      // examples/many_shapes.cpp
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "intaglio/error.h"
#include "intaglio/shape.h"
#include "intaglio/vec.h"

namespace intaglio {

inline constexpr std::size_t max_hull_points = 256;
inline constexpr std::size_t max_mesh_triangles = 100'000;

// The convex hull of points. Errors: fewer than four points that are not in one plane, numbers that are not
// finite, more than max_hull_points corners. Cost: milliseconds.
Result<ConvexHull> make_hull(std::span<const Vec3> points);

// A closed mesh; triangles counter-clockwise seen from outside. Errors: an index out of range, a triangle
// without area, an edge without a neighbour that runs the other way, inside out, more than
// max_mesh_triangles.
Result<Mesh> make_mesh(std::span<const Vec3> vertices, std::span<const std::array<int, 3>> triangles);

// An upper bound of the distance of any point of the shape from its origin, metres.
double bounding_radius(const Shape& shape);

struct MassProperties {
  double volume = 0;            // m^3
  Vec3 centre = Vec3::Zero();   // of mass, body frame, m
  Mat3 inertia = Mat3::Zero();  // about the centre, body axes, for density 1 kg/m^3: kg m^2 per kg/m^3
};

// For uniform density. Overlapping children of a compound count twice.
MassProperties mass_properties(const Shape& shape);

}  // namespace intaglio
