// Vibration is measured in bands that add up, and in multiples of what is just felt.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "core/portable_math.h"
#include "evaluate/vibration.h"

using namespace intaglio;
using namespace intaglio::evaluate;

namespace {

constexpr double servo_rate = 1000;

std::vector<double> sine(double frequency, double amplitude, double seconds) {
  std::vector<double> trace(std::size_t(seconds * servo_rate));
  for (std::size_t n = 0; n < trace.size(); ++n)
    trace[n] = amplitude * std::sin(2 * std::numbers::pi * frequency * double(n) / servo_rate);
  return trace;
}

std::vector<double> random_trace(std::uint64_t seed, std::size_t count) {
  Random random(seed);
  std::vector<double> trace(count);
  for (double& value : trace) value = 3 + random.normal();
  return trace;
}

std::vector<double> times(std::vector<double> trace, double gain) {
  for (double& value : trace) value *= gain;
  return trace;
}

}  // namespace

TEST_CASE("the energies of the bands add up to the integral of the square") {
  for (const std::size_t count : {std::size_t(1), std::size_t(2), std::size_t(500), std::size_t(1999)}) {
    const auto trace = random_trace(count, count);
    const double squares = std::inner_product(trace.begin(), trace.end(), trace.begin(), 0.0);
    for (const double rate : {1000.0, 2000.0}) {
      const VibrationEnergy energy = vibration_energy(trace, rate);
      CHECK(energy.total() == doctest::Approx(squares / rate).epsilon(1e-12));
      if (rate == 1000) CHECK(energy.above == 0);
    }
  }
  CHECK(vibration_energy({}, 1000).total() == 0);
}

TEST_CASE("a sine's energy lies in its band") {
  for (int band = 0; band < vibration_band_count; ++band) {
    const double frequency = std::sqrt(vibration_band_edge(band) * vibration_band_edge(band + 1));
    const VibrationEnergy energy = vibration_energy(sine(frequency, 0.5, 4), servo_rate);
    CAPTURE(band);
    CHECK(energy.bands[std::size_t(band)] > 0.98 * energy.total());
    // Half the square of the amplitude, for four seconds.
    CHECK(energy.total() == doctest::Approx(0.5 * 0.25 * 4).epsilon(0.01));
  }
  CHECK(vibration_energy(sine(3, 1, 4), servo_rate).below > 1.9);
}

TEST_CASE("the bands have one ratio from 10 to 500 Hz") {
  CHECK(vibration_band_edge(0) == doctest::Approx(10));
  CHECK(vibration_band_edge(9) == doctest::Approx(500));
  for (int edge = 0; edge < 9; ++edge)
    CHECK(vibration_band_edge(edge + 1) / vibration_band_edge(edge) ==
          doctest::Approx(std::pow(50, 1.0 / 9)));
}

TEST_CASE("energy grows with the square of a trace and intensity in proportion") {
  const auto trace = random_trace(7, 800);
  const VibrationEnergy one = vibration_energy(trace, servo_rate),
                        three = vibration_energy(times(trace, 3), servo_rate);
  for (std::size_t b = 0; b < one.bands.size(); ++b)
    CHECK(three.bands[b] == doctest::Approx(9 * one.bands[b]).epsilon(1e-12));
  const VibrationIntensity weak = vibration_intensity(trace, servo_rate);
  const VibrationIntensity strong = vibration_intensity(times(trace, -3), servo_rate);
  CHECK(strong.pacinian / weak.pacinian == doctest::Approx(3));
  CHECK(strong.non_pacinian / weak.non_pacinian == doctest::Approx(3));
  CHECK(strong.felt() / weak.felt() == doctest::Approx(3));
  // Decibels of energy.
  CHECK(band_distance(one, three) == doctest::Approx(20 * std::log10(3)));
  CHECK(band_distance(one, one) == 0);
}

TEST_CASE("the thresholds have the published values") {
  CHECK(pacinian_threshold(250) == doctest::Approx(0.1e-6));
  // Two octaves below the best frequency: 24 dB more.
  CHECK(pacinian_threshold(62.5) == doctest::Approx(0.1e-6 * std::pow(10, 1.2)));
  CHECK(non_pacinian_threshold(40) == doctest::Approx(1e-6 * std::pow(10, 0.6)));
  CHECK(non_pacinian_threshold(20) == doctest::Approx(1e-6 * std::pow(10, 0.85)));
  CHECK(non_pacinian_threshold(1) == doctest::Approx(1e-6 * std::pow(10, 1.4)));
  // The channels change places near 40 Hz.
  CHECK(non_pacinian_threshold(30) < pacinian_threshold(30));
  CHECK(pacinian_threshold(50) < non_pacinian_threshold(50));
}

TEST_CASE("a sine at its channel's threshold has intensity one in it") {
  const VibrationIntensity high = vibration_intensity(sine(250, pacinian_threshold(250), 2.048), servo_rate);
  CHECK(high.pacinian == doctest::Approx(1).epsilon(0.001));
  CHECK(high.non_pacinian < 0.03);
  CHECK(high.felt() == doctest::Approx(high.pacinian + 0.5 * high.non_pacinian));
  const double f = 10 * servo_rate / 1024;
  const VibrationIntensity low = vibration_intensity(sine(f, non_pacinian_threshold(f), 2.048), servo_rate);
  CHECK(low.non_pacinian == doctest::Approx(1).epsilon(0.001));
  CHECK(low.pacinian < 0.3);
}

TEST_CASE("the stronger channel counts fully and the weaker one by half") {
  CHECK(VibrationIntensity{4, 2}.felt() == 5);
  CHECK(VibrationIntensity{2, 4}.felt() == 5);
}

TEST_CASE("a force that presses steadily is not felt as vibration") {
  const std::vector<double> force(1000, 2.5);
  const VibrationIntensity intensity = vibration_intensity(displacement_of_force(force), servo_rate);
  CHECK(intensity.felt() < 1e-9);
  CHECK(vibration_energy(force, servo_rate).constant == doctest::Approx(6.25));
  CHECK(std::isnan(band_distance(vibration_energy(force, servo_rate), vibration_energy(force, servo_rate))));
  CHECK(displacement_of_force(force, 500)[0] == doctest::Approx(0.005));
}

TEST_CASE("a step of intensity is one Weber fraction, and what is not felt does not differ") {
  CHECK(intensity_steps(12, 10, 0.2) == doctest::Approx(1));
  CHECK(intensity_steps(10, 12, 0.2) == doctest::Approx(1));
  CHECK(intensity_steps(10 * 1.58 * 1.58, 10, greatest_weber_fraction) == doctest::Approx(2));
  CHECK(intensity_steps(0.9, 0.1) == 0);
  CHECK(intensity_steps(5, 5) == 0);
}

TEST_CASE("a band that is silent counts as the range below the greatest one") {
  VibrationEnergy one, other;
  one.bands[3] = 1;
  other.bands[3] = 1;
  other.bands[5] = 1;
  CHECK(band_distance(one, other) == doctest::Approx(40.0 / 3));
  CHECK(band_distance(one, other, 20) == doctest::Approx(20.0 / 3));
}
