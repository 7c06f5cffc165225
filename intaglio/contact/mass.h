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

}  // namespace intaglio::contact
