// The series that each sense delivers along one crossing, each beside what the reference delivers at the
// same places: slopes that are seen and felt, accelerations, and how strongly the sound is excited.
//
// A picture and a force are judged where the probe is drawn, against the true relief there: as it is for
// sight, and as a mean over the tip for touch, because a feature is what remains of the relief at the probe's
// size. Motion and sound are judged against the reference's own, at the moment at which its probe is drawn at
// the same place. Pure; any thread; a second of CPU.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "evaluate/crossing.h"
#include "evaluate/sight.h"

namespace intaglio::evaluate {

enum class Sense { picture, touch, motion, sound };
inline constexpr std::size_t senses = 4;
const char* name_of(Sense sense);

// The series of one crossing, all at `rate` from `start`.
struct Traces {
  Probe probe = Probe::pen;
  double rate = 0, start = 0;         // Hz, s
  double hand_scale = 1;              // scene metres per hand metre
  std::vector<double> distance;       // m along the path
  std::vector<std::size_t> features;  // where in the series the features are crossed
  // Whether the reference's own sound tells each feature; empty: all. Under the noise of a rough material
  // the gentle ones cannot be heard on any representation, nor in reality.
  std::vector<bool> is_heard;
  struct Series {
    std::vector<double> delivered, reference;
    // How strongly what is delivered changes, of touch and motion: a sound is made by that change.
    std::vector<double> change = {};
  };
  std::array<std::optional<Series>, senses> of;  // picture, touch or motion, sound

  double seconds() const { return double(distance.size()) / rate; }
};

// `reference`: the same crossing on the reference. `sight` is the picture's; null: not looked at.
Traces make_traces(const Subject& subject, const Crossing& crossing, const Crossing& reference,
                   const Sight* sight);
// Those of the reference itself, seen by its true slopes: what the meter reads where there is no conflict.
Traces reference_traces(const Subject& subject, const Crossing& reference);

// Faults of one sense, applied to a recorded crossing: what another time, place or texture would have given.
struct StreamFault {
  double delay = 0;               // s, later
  double shift = 0;               // m in the scene, along the path
  const Traces* other = nullptr;  // of another texture along the same path
  bool off = false;
};
Traces with_fault(const Traces& traces, Sense sense, const StreamFault& fault);

// Indices of the extrema of a series whose prominence, to either side, is at least `least`.
std::vector<std::size_t> extrema(const std::vector<double>& series, double least);

}  // namespace intaglio::evaluate
