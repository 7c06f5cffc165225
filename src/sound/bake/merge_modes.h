// Merges modes that cannot be told apart, to make a model cheaper to play, and the measure of what that
// changes.
//
// Two modes are merged if they decay before one beat is audible (|omega_i - omega_k| <= (d_i + d_k) / 2: at
// the first trough they are 27 dB down) and neither moves by more than 0.2 % in pitch, the least that is
// heard. The merged mode has the sum of their radiated shapes, which for modes of equal frequency is exactly
// what they sound like together (radiation.h). A mode is dropped when it stays 20 dB below its band for every
// strike point and direction. Either happens only while no auditory band changes by more than `allowed_db`.
// Shapes merged from different frequencies are no longer mass-normalised; scaled up (modal_model.h), modes
// ring longer for their distance, and the error grows. Cost: some 0.4 s for 100 modes. Sources: Raghuvanshi &
// Lin, "Interactive sound synthesis for large scale environments", 2006 (merging what is not discriminated);
// Wier, Jesteadt & Green, "Frequency discrimination as a function of frequency and sensation level", 1977
// (0.2 %).
#pragma once

#include <span>
#include <vector>

#include "sound/modal_model.h"

namespace intaglio::sound {

// Merges modes of `model` and records in it how many there were and what changed: at most `allowed_db` in any
// band, at any of its points, for a strike in any direction. 0 merges nothing.
void merge_modes(ModalModel& model, double allowed_db);

// Energy that a struck body radiates in each auditory band.
//
// An impulse n at a point makes the pressure sum of g_m . n e^(-d_m t) cos(omega_m t), g_m = radiation times
// shape. Behind an auditory filter of power response W its energy over all time is
//
//   E = n^T Q n,   Q = sum over pairs of S_ik g_i g_k^T,
//
// where S_ik is the integral of W times the product of both resonance curves: beating between modes and the
// skirts of their resonances are included. Filters are one ERB apart. Pure, any thread. Cost: milliseconds
// per band for 100 modes and 2,000 points. Sources: Glasberg & Moore, "Derivation of auditory filter shapes
// from notched-noise data", 1990 (ERB); Patterson et al., "The deterioration of hearing with age", 1982 (the
// rounded exponential filter).

double erb(double hertz);                               // bandwidth at that frequency, Hz
double erb_number(double hertz);                        // ERB-rate number: how many bandwidths lie below
double hertz_at_erb(double number);                     // its inverse
double auditory_response(double hertz, double centre);  // W: of power, 1 at the centre

// Modes with their gain g at every surface point, rows 3 p + axis.
struct AudibleModes {
  Eigen::VectorXd angular_frequency, damping;
  Eigen::MatrixXd gain;

  Eigen::Index modes() const { return angular_frequency.size(); }
  Eigen::Index points() const { return gain.rows() / 3; }
};

// Every `stride`-th point of the model.
AudibleModes audible_modes(const ModalModel& model, int stride = 1);

// Centres of all bands between the lowest and the highest mode, Hz.
std::vector<double> band_centres(const AudibleModes& modes);
// Q of each point, Pa^2 s for an impulse of 1 N s.
std::vector<Mat3> band_energy(const AudibleModes& modes, double centre);

struct Band {
  double centre = 0;         // Hz
  std::vector<Mat3> energy;  // Q of each point
  Mat3 mean;                 // over the points
};
// The bands with audible content: those below 1e-6 of the strongest band's energy are dropped.
std::vector<Band> audible_bands(const AudibleModes& modes);

// Difference in band energy between two mode sets of one surface, in dB: the maximum over the given bands,
// points and strike directions, and the RMS over bands and points, averaged over directions. A tenth of the
// band's mean over the surface is added to both, because near a node of one band other bands mask it.
struct SpectralError {
  double max_db = 0, rms_db = 0;
};
inline constexpr double node_floor = 0.1;
SpectralError spectral_error(std::span<const Band> before, const AudibleModes& after);

}  // namespace intaglio::sound
