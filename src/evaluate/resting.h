// How bodies come to rest on a representation: dropped balls, boxes and hulls, beside how they rest on the
// reference. A body is watched in spans of half a second, for three seconds, or until it hardly moves in one.
//
// A ball's true rest is the dilation of the relief by it (Reference::rest_on); a box's or hull's is where the
// reference's body settles within 0.15 s from the pose at which the candidate's lies. Bodies are alone in
// their worlds. Deterministic; about 20 ms of CPU a body, and 30 ms more for the settling.
#pragma once

#include <cstdint>
#include <vector>

#include "evaluate/body_truth.h"

namespace intaglio::evaluate {

struct Drop {
  BodyKind kind = BodyKind::ball;
  BodyState start;  // local, of the reference's relief
};
// `count` drops from 0.07 to 0.12 of the side above the middle of the surface: balls, boxes, hulls by turns.
std::vector<Drop> plan_drops(std::uint64_t seed, int count, double size);

struct RestOfBody {
  BodyKind kind = BodyKind::ball;
  // In the last half second it moves by less than 5 mm/s and turns by less than 0.1 rad/s, on average:
  // engines
  // report speeds that no body moves at. And it is still on the surface.
  bool at_rest = false;
  // The rest is of bodies at rest; not numbers for others.
  double height_mm = 0;   // above the true rest; negative: below
  double tilt = 0;        // degrees between orientations; not a number for a ball
  double overlap_mm = 0;  // with the relief, along the normal; 0 where it does not overlap
  double creep_mm = 0;    // way of the centre in the last half second
};
std::vector<RestOfBody> rests(const Subject& subject, const Candidate& candidate,
                              const std::vector<Drop>& drops);

struct RestStatistics {
  std::size_t bodies = 0;
  double at_rest = 0;    // share of all
  double height_mm = 0;  // mean of the absolute values
  double tilt = 0;       // degrees, mean over boxes and hulls
  double sunk = 0;       // share of those at rest that overlap the relief by more than 1 mm
  double creep_mm = 0;   // mean
};
RestStatistics rest_statistics(const std::vector<RestOfBody>& rests);

}  // namespace intaglio::evaluate
