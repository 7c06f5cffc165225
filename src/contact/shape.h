// The shapes that contact knows, in the body frame: metres, origin wherever the owner wants it (Bullet wants
// it in the centre of mass; see shape.h). Plain values, cheap to copy: hulls, meshes and compounds share what
// they hold. A size of zero or below, or one that is not finite, is answered with Status::no_size.
#pragma once

#include <memory>
#include <variant>
#include <vector>

#include "contact/polyhedron.h"
#include "intaglio/vec.h"

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

// Volume, centre of mass and inertia of a shape of uniform density: closed forms for the round ones and the
// box, tetrahedra under the faces for polyhedra (Mirtich, "Fast and accurate computation of polyhedral mass
// properties", 1996, names the integrals). Overlapping children of a compound count twice.

struct MassProperties {
  double volume = 0;            // m^3
  Vec3 centre = Vec3::Zero();   // of mass, body frame, m
  Mat3 inertia = Mat3::Zero();  // about the centre, body axes, for density 1 kg/m^3: kg m^2 per kg/m^3
};

MassProperties mass_properties(const Shape& shape);

// Of what a closed surface encloses, given triangle by triangle, counter-clockwise seen from outside: the
// sums over tetrahedra under them. Of an open surface the volume means nothing.
class EnclosedMass {
 public:
  void add(const Vec3& a, const Vec3& b, const Vec3& c);
  MassProperties properties() const;

 private:
  // Integrals of 1, x and x x^T over tetrahedra from the origin.
  double volume_ = 0;
  Vec3 first_ = Vec3::Zero();
  Mat3 second_ = Mat3::Zero();
};

}  // namespace intaglio::contact
