// Volume, centre of mass and inertia of a shape of uniform density: closed forms for the round ones and the
// box, tetrahedra under the faces for polyhedra (Mirtich, "Fast and accurate computation of polyhedral mass
// properties", 1996, names the integrals). Overlapping children of a compound count twice.
#pragma once

#include "intaglio/contact/shape.h"

namespace intaglio::contact {

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
