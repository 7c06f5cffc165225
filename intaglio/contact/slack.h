// How far from a true least gap a pair of features may be and still be reported. Internal to contact/.
//
// A body that rests on a flat place is never exactly parallel to it: all corners that are about to touch must
// be reported, not only the one that is nearest by a hair.
#pragma once

#include "intaglio/core/vec.h"

namespace intaglio::contact {

// Corners of the body: sine of the angle by which the normal may leave the corner's cone of normals.
inline constexpr double corner_slack = 0.34;
// Faces and edges against the relief: likewise, 3 degrees.
inline constexpr double slack = 0.05;
// And when they overlap by more than an eighth of what counts: then a pair that is no least gap misleads.
inline constexpr double overlap_slack = 1e-3;
inline double slack_at(double distance, double overlap) {
  return distance > -0.125 * overlap ? slack : overlap_slack;
}
// A bend of the relief below this slope is no corner and no crease.
inline constexpr double flat_bend = 1e-6;

// An angle's slack as one of a slope whose square is given.
inline double slope_slack(double angle, double slope2) {
  return angle * (1 + slope2);
}

}  // namespace intaglio::contact
