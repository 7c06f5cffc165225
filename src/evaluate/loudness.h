// How loud a sound is, by Zwicker's method as standardised in ISO 532-1:2017 (which contains DIN 45631).
//
// Loudness is in sone (1 sone: a tone of 1 kHz at 40 dB; four times as loud is 4 sone), specific loudness in
// sone per Bark, at 240 steps of 0.1 Bark. Sound is pressure in Pa at the ear, 36 kHz or more for the whole
// range of hearing; levels are third octaves in dB above 20 micropascal, valid up to 120 dB. The tables, the
// core loudness, the upper slopes, the decay after a sound ends (5, 15 and 75 ms) and the weighting of its
// beginning (3.5 and 70 ms) are the standard's; the band filters are third_octaves.h's, not the standard's
// own coefficients. The method follows the equal-loudness contours of ISO 226:1987, so tones below 500 Hz
// are louder than by those of 2003 and 2023, and above 5 kHz by up to 10 phon.
//
// Pure functions, any thread; about 30 ms for 1 s of sound; bit-identical on x86-64.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "evaluate/third_octaves.h"

namespace intaglio::evaluate {

inline constexpr int bark_steps = 240;
// Sone per Bark at 0.1, 0.2, ... 24 Bark.
using SpecificLoudness = std::array<double, bark_steps>;

// Whether sound arrives from the front or from all around.
enum class SoundField { free, diffuse };

struct Loudness {
  double sone = 0;
  SpecificLoudness specific{};
};

// A stationary sound (ISO 532-1, section 5). The first 0.2 s of a waveform, but at most half of it, are
// skipped, in which the filters respond to its beginning.
Loudness loudness_of_levels(const ThirdOctaves& levels, SoundField field = SoundField::free);
Loudness stationary_loudness(std::span<const float> pressure, double rate,
                             SoundField field = SoundField::free);

// Over time (section 6).
struct LoudnessTrace {
  double step = 0;                         // s between values of `sone`, 2 ms
  std::vector<double> sone;                // weighted as the ear does
  double frame = 0;                        // s that each of `specific` is the mean of
  std::vector<SpecificLoudness> specific;  // not weighted
};
// A sound's decay behind its end is not counted. `frame` is a whole number of milliseconds, at least 2.
LoudnessTrace loudness_over_time(std::span<const float> pressure, double rate, double frame = 0.02,
                                 SoundField field = SoundField::free);

// The loudness exceeded in a fraction of the time: 0.05 is N5, by which people judge sounds that vary. Zero
// for no sound.
double exceeded_loudness(const LoudnessTrace& trace, double fraction);

// The mean over frames of the integral of |N1' - N2'| over Bark, in sone; the shorter trace continues in
// silence. Both traces have one length of frames. Zero for two empty ones.
double loudness_distance(const LoudnessTrace& one, const LoudnessTrace& other);

// The level of a tone of 1 kHz that is as loud, in phon.
double phon_of_sone(double sone);

}  // namespace intaglio::evaluate
