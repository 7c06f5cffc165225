// Third-octave bands of a sound over time, as the loudness and the spectral distance need them.
//
// The bands are those of ISO 532-1: 28, centred at 1000 Hz times 10^(k/10), 25 Hz to 12.5 kHz. Each is a
// Chebyshev band-pass of sixth order, by the bilinear transform, that has the response of the standard's own
// filters at 48 kHz: flat within 0.02 dB, -3.3 dB at the edges (0.3 dB around it near 4 kHz and above),
// -20 dB at the neighbouring centres, -39 and -51 dB at the next two. Bands whose upper neighbour's centre
// is above 0.45 of the sample rate are silent: below 35.3 kHz the highest are missing.
// Pure functions, any thread; about 10 ms for 1 s of sound at 48 kHz; bit-identical on x86-64.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace intaglio::evaluate {

inline constexpr int third_octave_count = 28;
// A mean square of pressure, or a level, of each band.
using ThirdOctaves = std::array<double, third_octave_count>;

// Hz.
double third_octave_centre(int band);

// Mean square of each band from `skip` seconds to the end of the sound; zero for none.
ThirdOctaves third_octave_powers(std::span<const float> sound, double rate, double skip = 0);

// Squares smoothed by three low-passes of 2 / (3 f) seconds each, f being the band's centre but at most 1 kHz
// (ISO 532-1, 6.3), `per_second` times a second from the beginning.
std::vector<ThirdOctaves> third_octave_envelopes(std::span<const float> sound, double rate,
                                                 double per_second);

// dB above 20 micropascal, from Pa^2; at least -26 dB.
ThirdOctaves third_octave_levels(const ThirdOctaves& powers);

}  // namespace intaglio::evaluate
