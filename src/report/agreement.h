// Measures of agreement between the senses of a recording. NaN when not applicable (no pen, no audio, ...).
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "session/recording.h"

namespace intaglio::report {

struct Agreement {
  static constexpr double tolerance = 0.005;    // s, between a sound and its touch
  static constexpr double still_speed = 0.005;  // m/s, below which a touching body rests
  static constexpr double mode_width = 0.03;    // of a frequency, to either side

  // Touched when heard: fraction of the loud onsets that are near a touch. onset_chance: the score of random
  // onsets, which is the measure of the union of the windows of +-tolerance around all touches, over the
  // duration.
  std::size_t onsets = 0;
  double onsets_at_touch = 0, onset_chance = 0;
  double median_lag = 0;  // s, from touch to onset, over matched onsets
  // Heard when touched: fraction of unmasked touches with a loud onset nearby.
  std::size_t touches = 0;
  double touches_heard = 0, touch_chance = 0;

  // Felt what is there: Pearson correlation of the tip's height with the height of the surface under it,
  // while touching.
  double relief_correlation = 0;
  std::size_t touching_ticks = 0;

  // Silent when nothing happens: energy later than the longest T60 after any beginning or sliding contact.
  double idle_energy = 0;  // fraction of all
  double idle_seconds = 0;

  // Sounds like its bodies: energy within mode_width of a baked frequency of a body that was touched.
  double modal_energy = 0;  // fraction of the energy between 20 Hz and 20 kHz
  double modal_chance = 0;  // what noise of equal energy an octave would score

  // Rings above the floor: median contrast of the isolated modes (ModalSpectrum::contrasts_db).
  double modal_contrast_db = 0;
  std::size_t contrast_modes = 0;
};

Agreement measure_agreement(const session::Recording& recording);

// A list of sentences, each with its value.
std::string agreement_html(const Agreement& agreement);

// Audible impacts of a recording: contacts that begin, and edges struck while sliding or rolling.
//
// During sustained contact only the increase of a step's impulse counts as an impact (sound/contact_step.h).
// Any thread.
struct AudibleTouch {
  // s; impacts of one pair closer than this are merged, keeping the strongest.
  static constexpr double merge_window = 0.005;
  // Least impulse, as a fraction of the body's strongest: light bodies strike as bright as heavy ones.
  static constexpr double min_fraction = 0.02;

  double time = 0;     // s, of the touch where it is known, otherwise the middle of its step
  BodyId body = 0;     // the touching body
  double impulse = 0;  // N s, the increase
};

// In order of time, all at least `min_fraction` of their body's strongest.
std::vector<AudibleTouch> find_touches(const session::Recording& recording);

// Touches that should be audible: at least a tenth of their body's strongest, and at least twice every touch
// in the preceding 100 ms, which would mask them.
std::vector<AudibleTouch> unmasked(std::span<const AudibleTouch> touches);

}  // namespace intaglio::report
