// How much two sounds differ in spectrum and in decay.
//
// The spectral distance compares levels, in dB, in Zwicker's 24 critical bands and in frames of three lengths
// (about 10, 40 and 160 ms, Hann windows that overlap by three quarters), so that onsets and pitches both
// count: per length the root mean square of the level differences over all bands and frames in which either
// sound is within 60 dB of the louder one's greatest level; then the mean of the three lengths. A band that
// holds no frequency of a length is left out there. The shorter sound continues in silence.
//
// Decay times are T60 in third octaves, by a straight line from -5 to -25 dB through Schroeder's backward
// integral (ISO 3382-1's T20). The band filter itself decays in 7 / (0.23 f) s or so: 0.03 s at 1 kHz, 0.3 s
// at 100 Hz; shorter times cannot be measured. People notice differences of 5 % (ISO 3382-1, annex A).
//
// Any sample rate; bands above half of it are left out. Pure functions, any thread; about 20 ms for 1 s of
// sound; bit-identical on x86-64. Sources: Zwicker, "Subdivision of the audible frequency range into
// critical bands", JASA 33, 1961; Schroeder, "New method of measuring reverberation time", JASA 37, 1965.
#pragma once

#include <span>

#include "evaluate/third_octaves.h"

namespace intaglio::evaluate {

struct SpectrumDistanceOptions {
  bool ignore_gain = false;  // scales both sounds to one root mean square first
  double range = 60;         // dB below the greatest level that counts
};

// dB; 0 for equal sounds. Symmetric. Not a number when nothing is to be compared: two silences, or with
// `ignore_gain` one silence.
double log_spectral_distance(std::span<const float> one, std::span<const float> other, double rate,
                             const SpectrumDistanceOptions& options = {});

// Seconds for 60 dB in each band; not a number in a band that is 50 dB or more below the loudest one, or that
// does not fall by 25 dB before the sound ends.
ThirdOctaves decay_times(std::span<const float> sound, double rate);

// The mean of |ln(T1 / T2)| over the bands that have both: 0.05 is 5 %. Not a number without such a band.
double decay_difference(const ThirdOctaves& one, const ThirdOctaves& other);

}  // namespace intaglio::evaluate
