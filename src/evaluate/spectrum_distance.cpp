#include "evaluate/spectrum_distance.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/portable_math.h"
#include "evaluate/power_spectrum.h"

namespace intaglio::evaluate {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t bark_bands = 24;
constexpr double bark_edges[bark_bands + 1] = {0,    100,  200,  300,  400,  510,   630,  770,  920,
                                               1080, 1270, 1480, 1720, 2000, 2320,  2700, 3150, 3700,
                                               4400, 5300, 6400, 7700, 9500, 12000, 15500};
constexpr double frame_seconds[] = {0.01, 0.04, 0.16};

double decibels(double power) {
  return 10 / std::numbers::ln10 * elementary::log(power);
}

double mean_square(std::span<const float> sound) {
  double sum = 0;
  for (const float sample : sound) sum += double(sample) * double(sample);
  return sound.empty() ? 0 : sum / double(sound.size());
}

// Powers of the bands, frame by frame; `bands_held` are those that hold a frequency.
struct BandFrames {
  std::vector<std::array<double, bark_bands>> frames;
  std::array<bool, bark_bands> bands_held{};
};

BandFrames band_frames(std::span<const float> sound, double gain, std::size_t count, double rate,
                       std::size_t length) {
  std::vector<double> window(length), frame(length);
  for (std::size_t n = 0; n < length; ++n)
    window[n] = 0.5 - 0.5 * elementary::cos(2 * std::numbers::pi * (double(n) + 0.5) / double(length));
  std::vector<std::size_t> band_of(length / 2 + 1, bark_bands);
  BandFrames result;
  // A constant offset is no sound.
  for (std::size_t k = 1; k < band_of.size(); ++k) {
    const double frequency = double(k) * rate / double(length);
    const auto above = std::upper_bound(std::begin(bark_edges), std::end(bark_edges), frequency);
    band_of[k] = std::size_t(above - std::begin(bark_edges)) - 1;
    if (band_of[k] < bark_bands) result.bands_held[band_of[k]] = true;
  }
  PowerSpectrum spectrum(length);
  // Frames begin before the sound and end behind it, so that each sample is in four.
  const std::size_t hop = length / 4, before = length - hop;
  for (std::size_t start = 0; start < count + before; start += hop) {
    for (std::size_t n = 0; n < length; ++n) {
      const std::size_t place = start + n;
      const bool is_inside = place >= before && place - before < sound.size();
      frame[n] = is_inside ? window[n] * gain * double(sound[place - before]) : 0;
    }
    const auto power = spectrum(frame);
    auto& bands = result.frames.emplace_back();
    for (std::size_t k = 0; k < power.size(); ++k)
      if (band_of[k] < bark_bands) bands[band_of[k]] += power[k];
  }
  return result;
}

double greatest_power(const BandFrames& sound) {
  double greatest = 0;
  for (const auto& bands : sound.frames)
    greatest = std::max(greatest, *std::max_element(bands.begin(), bands.end()));
  return greatest;
}

// The root mean square of level differences of one frame length.
double distance_of_frames(const BandFrames& one, const BandFrames& other, double range) {
  const double greatest = std::max(greatest_power(one), greatest_power(other));
  const double floor = greatest * elementary::exp(-range / 10 * std::numbers::ln10);
  double sum = 0;
  std::size_t cells = 0;
  for (std::size_t n = 0; n < one.frames.size(); ++n)
    for (std::size_t b = 0; b < bark_bands; ++b) {
      const double p = one.frames[n][b], q = other.frames[n][b];
      if (!one.bands_held[b] || std::max(p, q) <= floor) continue;
      const double difference = decibels(std::max(p, floor)) - decibels(std::max(q, floor));
      sum += difference * difference;
      ++cells;
    }
  return cells == 0 ? undefined : std::sqrt(sum / double(cells));
}

// The time in which a straight line through the decay falls by 60 dB. `levels` in dB, falling.
double line_decay(const std::vector<double>& levels, double per_second) {
  const auto below = [&](double level) {
    return std::size_t(std::find_if(levels.begin(), levels.end(), [&](double l) { return l <= level; }) -
                       levels.begin());
  };
  const std::size_t first = below(-5), last = below(-25);
  if (last >= levels.size() || last < first + 2) return undefined;
  double t = 0, l = 0, tt = 0, tl = 0;
  const auto count = double(last - first + 1);
  for (std::size_t n = first; n <= last; ++n) {
    const double time = double(n - first) / per_second;
    t += time;
    l += levels[n];
    tt += time * time;
    tl += time * levels[n];
  }
  const double slope = (count * tl - t * l) / (count * tt - t * t);
  return slope < 0 ? -60 / slope : undefined;
}

}  // namespace

double log_spectral_distance(std::span<const float> one, std::span<const float> other, double rate,
                             const SpectrumDistanceOptions& options) {
  assert(rate > 0 && options.range > 0);
  double gain_one = 1, gain_other = 1;
  if (options.ignore_gain) {
    const double power_one = mean_square(one), power_other = mean_square(other);
    if (power_one == 0 || power_other == 0) return undefined;
    gain_one = 1 / std::sqrt(power_one);
    gain_other = 1 / std::sqrt(power_other);
  }
  const std::size_t count = std::max(one.size(), other.size());
  double sum = 0;
  for (const double seconds : frame_seconds) {
    // The power of two nearest to the length in ratio.
    const auto length =
        std::max<std::size_t>(power_of_two_from(std::size_t(seconds * rate / std::numbers::sqrt2)), 8);
    sum += distance_of_frames(band_frames(one, gain_one, count, rate, length),
                              band_frames(other, gain_other, count, rate, length), options.range);
  }
  return sum / double(std::size(frame_seconds));
}

ThirdOctaves decay_times(std::span<const float> sound, double rate) {
  constexpr double per_second = 2000;
  const auto envelopes = third_octave_envelopes(sound, rate, per_second);
  ThirdOctaves energies{};
  for (const ThirdOctaves& powers : envelopes)
    for (std::size_t b = 0; b < energies.size(); ++b) energies[b] += powers[b];
  const double loudest = *std::max_element(energies.begin(), energies.end());
  ThirdOctaves times{};
  for (std::size_t b = 0; b < energies.size(); ++b) {
    times[b] = undefined;
    if (!(energies[b] > 1e-5 * loudest)) continue;
    std::vector<double> levels(envelopes.size());
    double left = 0;
    for (std::size_t n = envelopes.size(); n-- > 0;) {
      left += envelopes[n][b];
      levels[n] = left > 0 ? decibels(left / energies[b]) : -1000;
    }
    times[b] = line_decay(levels, per_second);
  }
  return times;
}

double decay_difference(const ThirdOctaves& one, const ThirdOctaves& other) {
  double sum = 0;
  int bands = 0;
  for (std::size_t b = 0; b < one.size(); ++b) {
    if (std::isnan(one[b]) || std::isnan(other[b])) continue;
    sum += std::abs(elementary::log(one[b] / other[b]));
    ++bands;
  }
  return bands == 0 ? undefined : sum / bands;
}

}  // namespace intaglio::evaluate
