#include "evaluate/loudness.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/bootstrap.h"
#include "core/portable_math.h"

namespace intaglio::evaluate {
namespace {

// --- Tables of ISO 532-1:2017, annex A ---

constexpr std::size_t critical_bands = 20;  // as approximated by third octaves
constexpr std::size_t low_bands = 11;       // third octaves up to 250 Hz, which make the first three
using CoreLoudness = std::array<double, critical_bands + 1>;  // sone per Bark; the last is 0

// Level ranges and the reductions of low third octaves within them, after the equal-loudness contours.
constexpr double level_ranges[8] = {45, 55, 65, 71, 80, 90, 100, 120};
constexpr double low_reductions[8][low_bands] = {
    {-32, -24, -16, -10, -5, 0, -7, -3, 0, -2, 0}, {-29, -22, -15, -10, -4, 0, -7, -2, 0, -2, 0},
    {-27, -19, -14, -9, -4, 0, -6, -2, 0, -2, 0},  {-25, -17, -12, -9, -3, 0, -5, -2, 0, -2, 0},
    {-23, -16, -11, -7, -3, 0, -4, -1, 0, -1, 0},  {-20, -14, -10, -6, -3, 0, -4, -1, 0, -1, 0},
    {-18, -12, -9, -6, -2, 0, -3, -1, 0, -1, 0},   {-15, -10, -8, -4, -2, 0, -3, -1, 0, -1, 0}};
// Per critical band, in dB: threshold in quiet, transmission to the inner ear, diffuse against free field,
// and critical band against third octave.
constexpr double quiet_threshold[critical_bands] = {30, 18, 12, 8, 7, 6, 5, 4, 3, 3,
                                                    3,  3,  3,  3, 3, 3, 3, 3, 3, 3};
constexpr double ear_transmission[critical_bands] = {0,    0,    0,    0,    0,    0,  0,    0, 0, 0,
                                                     -0.5, -1.6, -3.2, -5.4, -5.6, -4, -1.5, 2, 5, 12};
constexpr double diffuse_difference[critical_bands] = {0, 0,    0.5, 0.9,  1.2, 1.6, 2.3, 2.8, 3,   2,
                                                       0, -1.4, -2,  -1.9, -1,  0.5, 3,   4,   4.3, 4};
constexpr double band_adaptation[critical_bands] = {-0.25, -0.6, -0.8, -0.8, -0.5, 0,   0.5, 1.1, 1.5, 1.7,
                                                    1.8,   1.8,  1.7,  1.6,  1.4,  1.2, 0.8, 0.5, 0,   -0.5};
// Upper limits of the critical bands, Bark.
constexpr double upper_limits[critical_bands + 1] = {0.9,  1.8,  2.8,  3.5,  4.4,  5.4,  6.6,
                                                     7.9,  9.2,  10.6, 12.3, 13.8, 15.2, 16.7,
                                                     18.1, 19.3, 20.6, 21.8, 22.7, 23.6, 24.0};
// Lower limits of ranges of specific loudness, and the slope in each behind critical bands 1 to 8 and above,
// sone per Bark^2.
constexpr std::size_t slope_ranges = 18;
constexpr double slope_limits[slope_ranges] = {21.5, 18,   15.1, 11.5, 9,    6.1,  4.4, 3.1,   2.13,
                                               1.36, 0.82, 0.42, 0.30, 0.22, 0.15, 0.1, 0.035, 0};
constexpr double slopes[slope_ranges][8] = {
    {13, 8.2, 6.3, 5.5, 5.5, 5.5, 5.5, 5.5},          {9, 7.5, 6, 5.1, 4.5, 4.5, 4.5, 4.5},
    {7.8, 6.7, 5.6, 4.9, 4.4, 3.9, 3.9, 3.9},         {6.2, 5.4, 4.6, 4.0, 3.5, 3.2, 3.2, 3.2},
    {4.5, 3.8, 3.6, 3.2, 2.9, 2.7, 2.7, 2.7},         {3.7, 3.0, 2.8, 2.35, 2.2, 2.2, 2.2, 2.2},
    {2.9, 2.3, 2.1, 1.9, 1.8, 1.7, 1.7, 1.7},         {2.4, 1.7, 1.5, 1.35, 1.3, 1.3, 1.3, 1.3},
    {1.95, 1.45, 1.3, 1.15, 1.1, 1.1, 1.1, 1.1},      {1.5, 1.2, 0.94, 0.86, 0.82, 0.82, 0.82, 0.82},
    {0.72, 0.67, 0.64, 0.63, 0.62, 0.62, 0.62, 0.62}, {0.59, 0.53, 0.51, 0.50, 0.42, 0.42, 0.42, 0.42},
    {0.40, 0.33, 0.26, 0.24, 0.24, 0.22, 0.22, 0.22}, {0.27, 0.21, 0.20, 0.18, 0.17, 0.17, 0.17, 0.17},
    {0.16, 0.15, 0.14, 0.12, 0.11, 0.11, 0.11, 0.11}, {0.12, 0.11, 0.10, 0.08, 0.08, 0.08, 0.08, 0.08},
    {0.09, 0.08, 0.07, 0.06, 0.06, 0.06, 0.06, 0.05}, {0.06, 0.05, 0.03, 0.02, 0.02, 0.02, 0.02, 0.02}};

double ten_to(double exponent) {
  return elementary::exp(exponent * std::numbers::ln10);
}

// Levels of the critical bands: the first three from third octaves of reduced level.
std::array<double, critical_bands> critical_band_levels(const ThirdOctaves& levels) {
  std::array<double, 3> intensities{};
  for (std::size_t b = 0; b < low_bands; ++b) {
    std::size_t range = 0;
    while (range < 7 && levels[b] > level_ranges[range] - low_reductions[range][b]) ++range;
    intensities[b < 6 ? 0 : b < 9 ? 1 : 2] += ten_to((levels[b] + low_reductions[range][b]) / 10);
  }
  std::array<double, critical_bands> critical{};
  for (std::size_t k = 0; k < 3; ++k) critical[k] = 10 / std::numbers::ln10 * elementary::log(intensities[k]);
  std::copy(levels.begin() + low_bands, levels.end(), critical.begin() + 3);
  return critical;
}

// Each critical band's own specific loudness, without its neighbours' slopes.
CoreLoudness core_loudness(const ThirdOctaves& levels, SoundField field) {
  constexpr double masking = 0.25;
  const auto critical = critical_band_levels(levels);
  CoreLoudness core{};
  for (std::size_t k = 0; k < critical_bands; ++k) {
    double level = critical[k] - ear_transmission[k];
    if (field == SoundField::diffuse) level += diffuse_difference[k];
    if (level <= quiet_threshold[k]) continue;
    level -= band_adaptation[k];
    const double excess = ten_to(0.1 * (level - quiet_threshold[k]));
    const double rise = std::sqrt(std::sqrt(1 - masking + masking * excess)) - 1;
    core[k] = std::max(0.0, 0.0635 * ten_to(0.025 * quiet_threshold[k]) * rise);
  }
  // The threshold in quiet changes within the lowest band.
  if (core[0] > 0) core[0] *= std::min(1.0, 0.4 + 0.32 * elementary::pow(core[0], 0.2));
  return core;
}

// Walks up the Bark scale: a band louder than the slope that arrives from below is a step up; otherwise the
// slope goes on, less steep from range to range, until it meets the band's own loudness.
class SlopeWalk {
 public:
  // Adds critical band `k` of core loudness `own`.
  void add(std::size_t k, double own) {
    const double limit = upper_limits[k];
    const std::size_t column = std::min<std::size_t>(k == 0 ? 0 : k - 1, 7);
    while (bark_ < limit) {
      if (height_ <= own) {
        height_ = own;
        advance(limit, 0);
        return;
      }
      std::size_t range = 0;
      while (slope_limits[range] >= height_ && range + 1 < slope_ranges) ++range;
      const double slope = slopes[range][column];
      const double floor = std::max(slope_limits[range], own);
      const double end = bark_ + (height_ - floor) / slope;
      if (end < limit) {
        advance(end, slope);
        height_ = floor;
      } else {
        advance(limit, slope);
      }
    }
  }

  Loudness result() && { return std::move(loudness_); }

 private:
  void advance(double to, double slope) {
    for (; step_ < bark_steps && 0.1 * (step_ + 1) <= to + 1e-9; ++step_)
      loudness_.specific[std::size_t(step_)] = std::max(0.0, height_ - slope * (0.1 * (step_ + 1) - bark_));
    const double after = std::max(0.0, height_ - slope * (to - bark_));
    loudness_.sone += (to - bark_) * (height_ + after) / 2;
    height_ = after;
    bark_ = to;
  }

  Loudness loudness_;
  double bark_ = 0, height_ = 0;
  int step_ = 0;
};

Loudness loudness_of_core(const CoreLoudness& core) {
  SlopeWalk walk;
  for (std::size_t k = 0; k <= critical_bands; ++k) walk.add(k, core[k]);
  return std::move(walk).result();
}

// --- Over time ---

constexpr double levels_per_second = 2000;  // of core loudness
constexpr int substeps = 24;                // in which both are interpolated
constexpr double substep = 1 / (levels_per_second * substeps);

// The decay of core loudness after a sound: a store that follows a rise at once and discharges, into a slow
// second store while that is lower (time constants 5, 15 and 75 ms of ISO 532-1, 6.4).
class DecayingStore {
 public:
  double next(double input) {
    if (input < output_) {
      discharge(input);
    } else {
      const bool is_held = std::abs(input - output_) < 1e-5 && input <= second_;
      output_ = input;
      second_ = is_held ? input : input + (second_ - input) * constants().charge;
    }
    return output_;
  }

 private:
  struct Constants {
    double slow, fast, weight_slow, weight_fast, both, charge;

    Constants() {
      constexpr double t_short = 0.005, t_long = 0.015, t_var = 0.075;
      constexpr double p = (t_var + t_long) / (t_var * t_short), q = 1 / (t_short * t_var);
      const double root = std::sqrt(p * p / 4 - q);
      // Eigenvalues of the two coupled stores; the output of each mode, the second store's being 1.
      weight_slow = 1 + t_var * (root - p / 2);
      weight_fast = 1 + t_var * (-root - p / 2);
      slow = elementary::exp((root - p / 2) * substep);
      fast = elementary::exp((-root - p / 2) * substep);
      both = elementary::exp(-substep / t_long);
      charge = elementary::exp(-substep / t_var);
    }
  };
  static const Constants& constants() {
    static const Constants all;
    return all;
  }

  void discharge(double input) {
    const Constants& c = constants();
    if (output_ > second_) {
      const double slow = (output_ - c.weight_fast * second_) / (c.weight_slow - c.weight_fast);
      const double fast = second_ - slow;
      output_ = std::max(input, c.weight_slow * slow * c.slow + c.weight_fast * fast * c.fast);
      second_ = std::min(output_, slow * c.slow + fast * c.fast);
    } else {
      output_ = std::max(input, output_ * c.both);
      second_ = output_;
    }
  }

  double output_ = 0, second_ = 0;
};

// Core loudness after the decay, at the same instants.
void let_decay(std::vector<CoreLoudness>& cores) {
  for (std::size_t k = 0; k < critical_bands; ++k) {
    DecayingStore store;
    for (std::size_t n = 0; n < cores.size(); ++n) {
      const double now = cores[n][k];
      const double after = n + 1 < cores.size() ? cores[n + 1][k] : 0;
      cores[n][k] = store.next(now);
      for (int s = 1; s < substeps; ++s) store.next(now + (after - now) * s / substeps);
    }
  }
}

// A low-pass of `seconds` over values that are interpolated linearly between instants.
std::vector<double> low_passed(const std::vector<double>& values, double seconds) {
  const double keep = elementary::exp(-substep / seconds);
  std::vector<double> result;
  double state = 0;
  for (std::size_t n = 0; n < values.size(); ++n) {
    const double now = values[n], after = n + 1 < values.size() ? values[n + 1] : 0;
    state = now + keep * (state - now);
    result.push_back(state);
    for (int s = 1; s < substeps; ++s) {
      const double value = now + (after - now) * s / substeps;
      state = value + keep * (state - value);
    }
  }
  return result;
}

}  // namespace

Loudness loudness_of_levels(const ThirdOctaves& levels, SoundField field) {
  return loudness_of_core(core_loudness(levels, field));
}

Loudness stationary_loudness(std::span<const float> pressure, double rate, SoundField field) {
  const double skip = std::min(0.2, 0.5 * double(pressure.size()) / rate);
  return loudness_of_levels(third_octave_levels(third_octave_powers(pressure, rate, skip)), field);
}

LoudnessTrace loudness_over_time(std::span<const float> pressure, double rate, double frame,
                                 SoundField field) {
  const auto per_frame = std::size_t(std::llround(frame * levels_per_second));
  assert(per_frame >= 4);
  std::vector<CoreLoudness> cores;
  for (const ThirdOctaves& powers : third_octave_envelopes(pressure, rate, levels_per_second))
    cores.push_back(core_loudness(third_octave_levels(powers), field));
  let_decay(cores);
  LoudnessTrace trace{4 / levels_per_second, {}, double(per_frame) / levels_per_second, {}};
  std::vector<double> sone;
  for (std::size_t n = 0; n < cores.size(); ++n) {
    const Loudness loudness = loudness_of_core(cores[n]);
    sone.push_back(loudness.sone);
    if (n % per_frame == 0) trace.specific.emplace_back();
    const double share = 1 / double(std::min(per_frame, cores.size() - n / per_frame * per_frame));
    for (std::size_t z = 0; z < bark_steps; ++z) trace.specific.back()[z] += share * loudness.specific[z];
  }
  const auto quick = low_passed(sone, 0.0035), slow = low_passed(sone, 0.07);
  for (std::size_t n = 0; n < sone.size(); n += 4) trace.sone.push_back(0.47 * quick[n] + 0.53 * slow[n]);
  return trace;
}

double exceeded_loudness(const LoudnessTrace& trace, double fraction) {
  return trace.sone.empty() ? 0 : quantile(trace.sone, 1 - fraction);
}

double loudness_distance(const LoudnessTrace& one, const LoudnessTrace& other) {
  assert(one.frame == other.frame);
  const std::size_t count = std::max(one.specific.size(), other.specific.size());
  const SpecificLoudness silence{};
  double sum = 0;
  for (std::size_t n = 0; n < count; ++n) {
    const SpecificLoudness& a = n < one.specific.size() ? one.specific[n] : silence;
    const SpecificLoudness& b = n < other.specific.size() ? other.specific[n] : silence;
    for (std::size_t z = 0; z < bark_steps; ++z) sum += 0.1 * std::abs(a[z] - b[z]);
  }
  return count == 0 ? 0 : sum / double(count);
}

double phon_of_sone(double sone) {
  if (sone >= 1) return 40 + 10 * elementary::log(sone) / std::numbers::ln2;
  return std::max(3.0, 40 * elementary::pow(sone + 0.0005, 0.35));
}

}  // namespace intaglio::evaluate
