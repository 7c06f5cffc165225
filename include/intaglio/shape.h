// The shapes of bodies, in the body's frame: metres, origin where you want it.
//
// Plain values, cheap to copy: hulls, meshes and compounds share what they hold, which is immutable. A shape
// whose size is zero, negative or not finite touches nothing, and the query says contact_status::no_size.
#pragma once

#include <memory>
#include <utility>
#include <variant>
#include <vector>

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

// Made by make_hull() (solid.h).
struct ConvexHull {
  std::shared_ptr<const Polyhedron> form;
};

// A closed triangle mesh, concave as it may be. Made by make_mesh() (solid.h).
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

// Compounds may be nested, eight deep at most.
inline Compound make_compound(std::vector<CompoundChild> children) {
  return {std::make_shared<const std::vector<CompoundChild>>(std::move(children))};
}

}  // namespace intaglio
