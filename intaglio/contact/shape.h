// The shapes that contact knows, in the body frame: metres, origin wherever the owner wants it (Bullet wants
// it in the centre of mass; see mass.h). Plain values, cheap to copy: hulls, meshes and compounds share what
// they hold. A size of zero or below, or one that is not finite, is answered with Status::no_size.
#pragma once

#include <memory>
#include <variant>
#include <vector>

#include "intaglio/contact/polyhedron.h"
#include "intaglio/core/vec.h"

namespace intaglio::contact {

// Round the origin.
struct Sphere {
  double radius = 0;
};

// All points within `radius` of the segment from -half_height to half_height along Y.
struct Capsule {
  double radius = 0;
  double half_height = 0;
};

struct Box {
  Vec3 half = Vec3::Zero();  // along X, Y, Z
};

// Round the Y axis.
struct Cylinder {
  double radius = 0;
  double half_height = 0;
};

struct ConvexHull {
  std::shared_ptr<const Polyhedron> form;  // by convex_hull()
};

// A closed triangle mesh, concave as it may be.
struct Mesh {
  std::shared_ptr<const Polyhedron> form;  // by closed_mesh()
};

struct CompoundChild;

// Shapes that move as one. Their contacts are found one by one, so children may overlap.
struct Compound {
  std::shared_ptr<const std::vector<CompoundChild>> children;
};

using Shape = std::variant<Sphere, Capsule, Box, Cylinder, ConvexHull, Mesh, Compound>;

struct CompoundChild {
  Shape shape;
  Pose pose;  // in the compound's frame
};

// The compound of these; one that holds compounds is as good as one that does not.
inline Compound make_compound(std::vector<CompoundChild> children) {
  return {std::make_shared<const std::vector<CompoundChild>>(std::move(children))};
}

// A bound of how far any point of the shape is from its origin.
double bounding_radius(const Shape& shape);

}  // namespace intaglio::contact
