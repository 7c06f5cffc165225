#include "evaluate/vibration.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/bootstrap.h"
#include "core/portable_math.h"
#include "evaluate/power_spectrum.h"

namespace intaglio::evaluate {
namespace {

constexpr double lowest_edge = 10, highest_edge = 500;

double octaves_between(double low, double high) {
  return elementary::log(high / low) / std::numbers::ln2;
}

// Amplitude in metres of a level above 1 micrometre.
double amplitude_of(double level) {
  return 1e-6 * elementary::exp(level / 20 * std::numbers::ln10);
}

// The trace's squares by frequency, without its mean; element k is at k * step Hz.
struct TracePower {
  std::vector<double> squares;
  double step = 0, mean = 0;
};

TracePower trace_power(std::span<const double> trace, double rate) {
  assert(rate > 0);
  TracePower result;
  if (trace.empty()) return result;
  result.mean = mean(trace);
  std::vector<double> rest;
  for (const double value : trace) rest.push_back(value - result.mean);
  const std::size_t length = std::max<std::size_t>(power_of_two_from(rest.size()), 2);
  PowerSpectrum spectrum(length);
  const auto power = spectrum(rest);
  result.squares.assign(power.begin(), power.end());
  result.step = rate / double(length);
  return result;
}

}  // namespace

double vibration_band_edge(int edge) {
  assert(edge >= 0 && edge <= vibration_band_count);
  return lowest_edge * elementary::pow(highest_edge / lowest_edge, double(edge) / vibration_band_count);
}

double VibrationEnergy::total() const {
  double sum = constant + below + above;
  for (const double band : bands) sum += band;
  return sum;
}

VibrationEnergy vibration_energy(std::span<const double> trace, double rate) {
  std::array<double, vibration_band_count + 1> edges{};
  for (std::size_t k = 0; k < edges.size(); ++k) edges[k] = vibration_band_edge(int(k));
  // The highest edge itself is within: at 1 kHz it is the highest frequency there is.
  edges.back() *= 1 + 1e-9;
  const TracePower power = trace_power(trace, rate);
  VibrationEnergy energy;
  energy.constant = power.mean * power.mean * double(trace.size()) / rate;
  for (std::size_t k = 0; k < power.squares.size(); ++k) {
    const double frequency = double(k) * power.step;
    const auto above = std::size_t(std::upper_bound(edges.begin(), edges.end(), frequency) - edges.begin());
    double& place = above == 0              ? energy.below
                    : above == edges.size() ? energy.above
                                            : energy.bands[above - 1];
    place += power.squares[k] / rate;
  }
  return energy;
}

double band_distance(const VibrationEnergy& one, const VibrationEnergy& other, double range) {
  const double greatest = std::max(*std::max_element(one.bands.begin(), one.bands.end()),
                                   *std::max_element(other.bands.begin(), other.bands.end()));
  if (!(greatest > 0)) return std::numeric_limits<double>::quiet_NaN();
  const double floor = greatest * elementary::exp(-range / 10 * std::numbers::ln10);
  double sum = 0;
  for (std::size_t b = 0; b < one.bands.size(); ++b) {
    const double ratio = std::max(one.bands[b], floor) / std::max(other.bands[b], floor);
    const double difference = 10 / std::numbers::ln10 * elementary::log(ratio);
    sum += difference * difference;
  }
  return std::sqrt(sum / vibration_band_count);
}

double pacinian_threshold(double frequency) {
  assert(frequency > 0);
  return amplitude_of(-20 + 12 * std::abs(octaves_between(250, frequency)));
}

double non_pacinian_threshold(double frequency) {
  assert(frequency > 0);
  return amplitude_of(std::min(28.0, 12 + 5 * std::max(0.0, octaves_between(frequency, 40))));
}

double VibrationIntensity::felt() const {
  return std::max(pacinian, non_pacinian) + 0.5 * std::min(pacinian, non_pacinian);
}

VibrationIntensity vibration_intensity(std::span<const double> displacement, double rate) {
  const TracePower power = trace_power(displacement, rate);
  VibrationIntensity intensity;
  for (std::size_t k = 1; k < power.squares.size(); ++k) {
    const double frequency = double(k) * power.step;
    // A sine's mean square is half its amplitude's square.
    const double square = 2 * power.squares[k] / double(displacement.size());
    const double p = pacinian_threshold(frequency), n = non_pacinian_threshold(frequency);
    intensity.pacinian += square / (p * p);
    intensity.non_pacinian += square / (n * n);
  }
  intensity.pacinian = std::sqrt(intensity.pacinian);
  intensity.non_pacinian = std::sqrt(intensity.non_pacinian);
  return intensity;
}

std::vector<double> displacement_of_force(std::span<const double> force, double stiffness) {
  assert(stiffness > 0);
  std::vector<double> displacement;
  for (const double value : force) displacement.push_back(value / stiffness);
  return displacement;
}

double intensity_steps(double one, double other, double weber) {
  assert(weber > 0);
  const double ratio = std::max(one, 1.0) / std::max(other, 1.0);
  return std::abs(elementary::log(ratio)) / elementary::log(1 + weber);
}

}  // namespace intaglio::evaluate
