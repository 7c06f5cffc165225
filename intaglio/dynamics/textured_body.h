// What a body with reliefs of its own (ShapeBody) is to Bullet, and what it weighs.
//
// Internal to dynamics/: includes Bullet.
#pragma once

#include "intaglio/contact/mass.h"
#include "intaglio/dynamics/bullet_shape.h"
#include "intaglio/dynamics/world.h"

namespace intaglio::dynamics {

// With what its reliefs take away: of a face the mean depth, of a skin what is between corners of its base.
// No volume where the skin is open.
contact::MassProperties mass_properties(const ShapeBody& body);
// A bound of how far any of its points is from the origin, m.
double reach(const ShapeBody& body);
// The scale of its own detail, m; 0 without.
double texel(const ShapeBody& body);

// Its reliefs, round a box that is set back by their depth, in the frame of a body that holds it at `held`.
BulletShape to_bullet(const ShapeBody& body, const Pose& held);

// A curved base without its relief.
surface::ReliefMesh bare(const surface::ReliefMesh& relief);

}  // namespace intaglio::dynamics
