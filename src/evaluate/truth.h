// How far one crossing is from the reference's, sense by sense. Pure functions of two crossings; SI units
// except where a name says otherwise. docs/evaluate.md explains each.
#pragma once

#include "evaluate/crossing.h"
#include "evaluate/sound_events.h"

namespace intaglio::evaluate {

struct TouchError {
  double force_n = 0;          // root mean square of the difference
  double direction = 0;        // degrees, mean while both touch; not a number if they never do
  double buzz_n = 0;           // force faster than 100 Hz, root mean square, beyond the reference's
  double bands_db = 0;         // of the energies in nine vibration bands
  double intensity_steps = 0;  // just noticeable steps between the intensities of vibration
  double pacinian_steps = 0, non_pacinian_steps = 0;  // likewise, of each channel
};
TouchError touch_error(const Crossing& crossing, const Crossing& reference);

struct MotionError {
  double place_mm = 0, height_mm = 0;  // root mean square, as MotionTruth says; not a number without restarts
};
MotionError motion_error(const Crossing& crossing);

// Degrees between the deepest contact's normal and the nearest of the reference's contacts, mean over the
// reference's states every 50 ms in which it touches; 90 where a candidate finds no contact.
double normal_error(const Subject& subject, const Candidate& candidate, const ReferenceRoll& reference);

struct SoundError {
  double spectrum_db = 0, loudness_sone = 0;
  OnsetMatch onsets;
  double intervals_ms = 0;  // between the trains of impulses; not a number where there is none
  double decay = 0;         // of a strike: mean of |ln(T1 / T2)| over third octaves; otherwise not a number
};
SoundError sound_error(const Crossing& crossing, const Crossing& reference);

}  // namespace intaglio::evaluate
