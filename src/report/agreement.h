// How well the senses of a recording agree, in numbers. What cannot be told (no pen, no audio, ...) is
// not-a-number.
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

  // Touched when heard: fraction of the loud onsets that are near a touch (agreement.h). Chance: what
  // sounds at random times would score.
  std::size_t onsets = 0;
  double onsets_at_touch = 0, onset_chance = 0;
  double median_lag = 0;  // s, of the onsets that have a touch, from it
  // Heard when touched: fraction of the touches that nothing masks that are near a loud onset.
  std::size_t touches = 0;
  double touches_heard = 0, touch_chance = 0;

  // Felt what is there: Pearson correlation of the tip's height with the height of the surface under it,
  // while touching.
  double relief_correlation = 0;
  std::size_t touching_ticks = 0;

  // Silent when nothing happens: energy in the time that is more than the longest T60 after any contact that
  // began or slid.
  double idle_energy = 0;  // fraction of all
  double idle_seconds = 0;

  // Sounds like its bodies: energy within mode_width of a baked frequency of a body that was touched.
  double modal_energy = 0;  // fraction of the energy between 20 Hz and 20 kHz
  double modal_chance = 0;  // what noise of equal energy an octave would score

  // Rings above the floor: power density near a mode over that beside it, the median of the modes that stand
  // apart.
  double modal_contrast_db = 0;
  std::size_t contrast_modes = 0;
};

Agreement agreement_of(const session::Recording& recording);

// Times (s) at which the audio gets loud: the energy of a millisecond is 6 dB above that of every one of the
// 30 before it, and within 40 dB of the loudest; at most one in 30 ms. Of the audio's differences, that is
// with treble raised: bass rings on from one impact to the next, treble starts anew.
std::vector<double> loud_onsets(std::span<const float> audio, double sample_rate);

// A list of sentences, each with its value.
std::string agreement_html(const Agreement& agreement);

// The touches of a recording that can be heard: contacts that begin, and edges met within one, as blows.
//
// A body that slides or rolls touches without a pause, and what strikes is what is new in the impulse of a
// step (sound/contact_force.h). Any thread.

struct Touch {
  static constexpr double apart = 0.005;  // s, within which the blows of one pair are one: the strongest
  static constexpr double least =
      0.02;  // of the strongest blow of its body: light ones strike as bright as heavy

  double time = 0;     // s, of the touch where it is known, else the middle of its step
  BodyId body = 0;     // who touches
  double impulse = 0;  // N s, what is new
};

// In order of time, all at least `least` of their body's strongest.
std::vector<Touch> touches_of(const session::Recording& recording);

// Those that must be heard: at least a tenth of their body's strongest, and not masked, twice as strong as
// all touches of the 100 ms before.
std::vector<Touch> unmasked(std::span<const Touch> touches);

}  // namespace intaglio::report
