// Measures of agreement between the senses of a session. NaN when not applicable (no pen, no audio, ...).
#pragma once

#include <cstddef>
#include <string>

#include "report/digest.h"

namespace intaglio::report {

struct Agreement {
  static constexpr double tolerance = 0.005;  // s, between a sound and its touch
  static constexpr double mode_width = 0.03;  // of a frequency, to either side

  // Touches and onsets of every `stride`th ten seconds were compared: 1 is all, more is a fair sample where
  // there are more than a digest keeps.
  std::size_t stride = 1;

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

Agreement measure_agreement(const Digest& digest);

// A list of sentences, each with its value.
std::string agreement_html(const Agreement& agreement);

}  // namespace intaglio::report
