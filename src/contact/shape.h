// Shapes (include/intaglio/shape.h) under the names of contact, and the mass that a closed surface encloses.
#pragma once

#include "contact/polyhedron.h"
#include "intaglio/solid.h"

namespace intaglio::contact {

using intaglio::bounding_radius;
using intaglio::Box;
using intaglio::Capsule;
using intaglio::Compound;
using intaglio::CompoundChild;
using intaglio::ConvexHull;
using intaglio::Cylinder;
using intaglio::make_compound;
using intaglio::mass_properties;
using intaglio::MassProperties;
using intaglio::Mesh;
using intaglio::Shape;
using intaglio::Sphere;

// Mass properties of the volume inside a closed surface, which is added triangle by triangle,
// counter-clockwise seen from outside: sums over the tetrahedra between the origin and each triangle. The
// volume of an open surface means nothing.
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
