// The shapes of bodies, in the body's frame: metres, origin where you want it.
//
// Plain values, cheap to copy: hulls, meshes and compounds share what they hold, which is immutable. A shape
// whose size is zero, negative or not finite touches nothing, and the query says contact_status::no_size.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/vec.h"

namespace intaglio {

// Around the origin.
struct Sphere {
  double radius = 0;
};

// All points within `radius` of the segment from -half_height to half_height along Y.
struct Capsule {
  double radius = 0;
  double half_height = 0;
};

struct Box {
  Vec3 half = Vec3::Zero();  // half the sides along X, Y, Z
};

// Around the Y axis.
struct Cylinder {
  double radius = 0;
  double half_height = 0;
};

struct Polyhedron;  // internal

inline constexpr std::size_t max_hull_points = 256;
inline constexpr std::size_t max_mesh_triangles = 100'000;

// Made by make_hull().
struct ConvexHull {
  std::shared_ptr<const Polyhedron> form;
};

// A closed triangle mesh, concave as it may be. Made by make_mesh().
struct Mesh {
  std::shared_ptr<const Polyhedron> form;
};

struct CompoundChild;

// Shapes that move as one; children may overlap. Made by make_compound().
struct Compound {
  std::shared_ptr<const std::vector<CompoundChild>> children;
};

using Shape = std::variant<Sphere, Capsule, Box, Cylinder, ConvexHull, Mesh, Compound>;

struct CompoundChild {
  Shape shape;
  Pose pose;  // in the compound's frame
};

// The convex hull of points. Errors: fewer than four points that are not in one plane, numbers that are not
// finite, more than max_hull_points corners. Cost: milliseconds.
Result<ConvexHull> make_hull(std::span<const Vec3> points);

// A closed mesh; triangles counter-clockwise seen from outside. Errors: an index out of range, a triangle
// without area, an edge without a neighbour that runs the other way, inside out, more than max_mesh_triangles.
Result<Mesh> make_mesh(std::span<const Vec3> vertices, std::span<const std::array<int, 3>> triangles);

// Compounds may be nested, eight deep at most.
inline Compound make_compound(std::vector<CompoundChild> children) {
  return {std::make_shared<const std::vector<CompoundChild>>(std::move(children))};
}

// An upper bound of the distance of any point of the shape from its origin, metres.
double bounding_radius(const Shape& shape);

struct MassProperties {
  double volume = 0;            // m^3
  Vec3 centre = Vec3::Zero();   // of mass, body frame, m
  Mat3 inertia = Mat3::Zero();  // about the centre, body axes, for density 1 kg/m^3: kg m^2 per kg/m^3
};

// Of uniform density. Overlapping children of a compound count twice.
MassProperties mass_properties(const Shape& shape);

}  // namespace intaglio
