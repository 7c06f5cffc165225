// How strong a vibration feels, and in which frequencies its energy lies: metrics of touch.
//
// A trace is displacement of the skin in metres at a servo's rate (1 kHz, so frequencies up to 500 Hz). A
// force becomes displacement by a stiffness of the skin; ratios of intensities do not depend on it.
//
// Intensity: two channels, the Pacinian and the non-Pacinian, each the trace's spectrum in multiples of the
// channel's detection threshold, summed in power; 1 is a sine that is just felt. Together they feel as
// strong as the stronger one plus half the weaker one (Hollins and Roy, "Perceived intensity of
// vibrotactile stimuli: the role of mechanoreceptive channels", 1996). Differences are noticed from a Weber
// fraction of 0.20 (thenar eminence, 125 Hz) to 0.58 (10 Hz) (Forta, Griffin and Morioka, 2012).
//
// Thresholds are straight lines over the logarithm of frequency through the published course of the curves
// for large contacts on the palm (Bolanowski, Gescheider, Verrillo, Checkosky, "Four channels mediate the
// mechanical aspects of touch", JASA 84, 1988; Gescheider and Verrillo, 1980): Pacinian -20 dB above 1
// micrometre (peak) at 250 Hz, 12 dB per octave more to both sides; non-Pacinian 12 dB from 40 Hz upward, 5
// dB per octave more below, at most 28 dB. They are not tabled data: people, places and contact areas
// differ by 10 dB and more, and the courses above 250 Hz (Pacinian) and above 40 Hz (non-Pacinian) are
// assumptions.
//
// Bands: nine of equal ratio (1.54, 0.63 octave) from 10 Hz, below which vibration is felt as motion, to
// 500 Hz. That there are nine follows arXiv 2605.23804, where the energy in nine critical bands predicts
// judged realism best; the edges are ours.
//
// Pure functions, any thread; about 1 ms for 1 s; bit-identical on x86-64.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace intaglio::evaluate {

inline constexpr int vibration_band_count = 9;

// Hz; edge 0 is 10 Hz, edge 9 is 500 Hz.
double vibration_band_edge(int edge);

// The integral over time of the trace's square, by frequency. Unit: the trace's squared, times seconds.
struct VibrationEnergy {
  double constant = 0;  // of its mean
  double below = 0;     // 10 Hz, without the mean
  std::array<double, vibration_band_count> bands{};
  double above = 0;  // 500 Hz

  double total() const;
};
VibrationEnergy vibration_energy(std::span<const double> trace, double rate);

// The root mean square over the bands of the difference in dB; a band counts as at least `range` dB below the
// greatest one of both. Not a number when both have no energy in any band.
double band_distance(const VibrationEnergy& one, const VibrationEnergy& other, double range = 40);

// Peak amplitude of a sine that is just felt, m. `frequency` above 0 Hz.
double pacinian_threshold(double frequency);
double non_pacinian_threshold(double frequency);

struct VibrationIntensity {
  double pacinian = 0, non_pacinian = 0;  // multiples of the threshold

  // The stronger one plus half the weaker one.
  double felt() const;
};
// The root mean square, over the whole trace and without its mean, in each channel.
VibrationIntensity vibration_intensity(std::span<const double> displacement, double rate);

// Displacement of skin that is pressed with a force in N: force over stiffness in N/m. 1000 N/m is the order
// of a fingertip's under 1 N.
std::vector<double> displacement_of_force(std::span<const double> force, double stiffness = 1000);

inline constexpr double least_weber_fraction = 0.20, greatest_weber_fraction = 0.58;

// How many just noticeable steps lie between two intensities: |ln(one / other)| / ln(1 + weber). Intensities
// below 1 are not felt and count as 1.
double intensity_steps(double one, double other, double weber = least_weber_fraction);

}  // namespace intaglio::evaluate
