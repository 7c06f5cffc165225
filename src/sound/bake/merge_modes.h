// Modes that no listener tells apart become one, so that a model costs less to play.
//
// Two modes are merged when they beat so slowly that they are gone before it is heard (|omega_i - omega_k| <=
// (d_i + d_k) / 2: at the first trough they are 27 dB down) and neither moves by more than 0.2 % in pitch,
// the least that is heard. The one has the sum of their radiated shapes, which of modes at one frequency is
// exactly what they sound like together (radiation.h). A mode is left out when 20 dB below its band wherever
// and however the body is struck. Both only as long as no auditory band changes by more than asked
// (merge_modes.h). Shapes merged from different frequencies are mass-normalised no longer; scaled up
// (modal_model.h), modes ring longer for their distance, and the error grows. Cost: some 0.4 s for 100
// modes. Sources: Raghuvanshi & Lin, "Interactive sound synthesis for large scale environments", 2006
// (merging what is not discriminated); Wier, Jesteadt & Green, "Frequency discrimination as a function of
// frequency and sensation level", 1977 (0.2 %).
#pragma once

#include <span>
#include <vector>

#include "sound/modal_model.h"

namespace intaglio::sound {

// Merges modes of `model` and states in it how many there were and what changed: at most `allowed_db` in any
// band, at any of its points, for a blow in any direction. 0 merges nothing.
void merge_modes(ModalModel& model, double allowed_db);

// What a blow on a body sounds like to the ear: the energy that it radiates in each auditory band.
//
// An impulse n at a point makes the pressure sum of g_m . n e^(-d_m t) cos(omega_m t), g_m = radiation times
// shape. Behind an auditory filter of power response W its energy over all time is the quadratic form n^T Q n
// Q = sum over pairs of S_ik g_i g_k^T, where S_ik is the integral of W times the product of both resonance
// curves: pairs that beat count as they beat, and skirts count. Filters are one ERB apart. Pure, any thread.
// Cost: milliseconds a band for 100 modes and 2,000 points. Sources: Glasberg & Moore, "Derivation of
// auditory filter shapes from notched-noise data", 1990 (ERB); Patterson et al., "The deterioration of
// hearing with age", 1982 (the rounded exponential filter).

double erb(double hertz);                               // the bandwidth there, Hz
double erb_number(double hertz);                        // how many such bands lie below
double hertz_at_erb(double number);                     // its inverse
double auditory_response(double hertz, double centre);  // W: of power, 1 at the centre

// Modes as they are heard: frequency, decay, and the gains g of every point, rows 3 p + axis.
struct HeardModes {
  Eigen::VectorXd angular_frequency, damping;
  Eigen::MatrixXd gain;

  Eigen::Index modes() const { return angular_frequency.size(); }
  Eigen::Index points() const { return gain.rows() / 3; }
};

// Every `stride`-th point of the model.
HeardModes heard_modes(const ModalModel& model, int stride = 1);

// Centres of the bands that the modes lie in, Hz.
std::vector<double> band_centres(const HeardModes& modes);
// Q of each point, Pa^2 s for an impulse of 1 N s.
std::vector<Mat3> band_energy(const HeardModes& modes, double centre);

// A band that modes are heard in: those with less than a millionth of the strongest one's energy are not.
struct Band {
  double centre = 0;         // Hz
  std::vector<Mat3> energy;  // Q of each point
  Mat3 mean;                 // over the points
};
std::vector<Band> bands_of(const HeardModes& modes);

// How differently two sets of modes of one surface sound, in dB of band energy: the worst over the bands
// given, points and directions of the blow, and the root mean square over bands and points, directions
// averaged. Of each band a tenth of its mean over the surface is added to both, since near a node of a band
// others are heard.
struct SpectralError {
  double max_db = 0, rms_db = 0;
};
inline constexpr double node_share = 0.1;
SpectralError spectral_error(std::span<const Band> before, const HeardModes& after);

}  // namespace intaglio::sound
