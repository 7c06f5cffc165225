// How boxes and hulls move over each representation, beside the reference: throws that restart from the
// reference's state, the normals at which they touch, and the energy that a rolling ball gains.
//
// SI units except where a name says otherwise; local coordinates of the surface. Deterministic; any thread.
#pragma once

#include <cstdint>
#include <vector>

#include "evaluate/reference_body.h"
#include "evaluate/subject.h"

namespace intaglio::evaluate {

enum class BodyKind { ball, box, hull };

// A body of a subject's size (its ball has a radius of 0.04 of the side); its frame is that of its principal
// axes about its centre of mass. The hull is irregular, of up to twelve corners, and always the same.
contact::Shape body_shape(BodyKind kind, double size);
ConvexForm body_form(const contact::Shape& shape);  // of a box or a hull
Material body_material();

struct ThrowOptions {
  BodyKind kind = BodyKind::box;
  BodyState start;
  double seconds = 0.6;
};
// The reference's states, from the start on, every 1 / reference_rate s, until it leaves the surface; and
// whether it touched during the step that led to each.
struct ReferenceThrow {
  BodyKind kind = BodyKind::box;
  std::vector<BodyState> states;
  std::vector<bool> touching;
};
ReferenceThrow reference_throw(const Subject& subject, const ThrowOptions& options);

struct ThrowError {
  // Root mean squares over restarts, not numbers without one: 0.1 s after the reference's state, along the
  // surface, across it, and by the angle between the orientations.
  double place_mm = 0, height_mm = 0, turn = 0;
  // Degrees between the deepest contact's normal and the nearest of the reference's contacts, mean over its
  // states every 50 ms in which it touches; 90 where a candidate finds no contact.
  double normal_angle = 0;
};
ThrowError throw_error(const Subject& subject, const Candidate& candidate, const ReferenceThrow& reference);

// Place and turn of the reference itself at half its rate; no normals, and the place is in space.
ThrowError half_rate_error(const Subject& subject, const ReferenceThrow& reference);

// Degrees, as above, of any body at `poses` where the reference has `normals`.
double contact_normal_error(const Subject& subject, const Candidate& candidate, const contact::Shape& shape,
                            const std::vector<Pose>& poses, const std::vector<std::vector<Vec3>>& normals);

// A ball without rolling resistance rolls from a state of the reference on its own: the largest rise of its
// energy above an earlier value, in J and as a share of the kinetic energy at the start. Friction and impacts
// may take energy; a rise is made of nothing.
struct EnergyRise {
  double gained_j = 0, share = 0;
};
EnergyRise energy_rise(const Subject& subject, const Candidate& candidate, const BodyState& start,
                       double seconds);
// Likewise of the reference's own ball: what the measure cannot tell from 0.
EnergyRise reference_energy_rise(const Subject& subject, const BodyState& start, double seconds);

}  // namespace intaglio::evaluate
