// Distances of spectrum and decay have closed forms for gains, filters and decaying sounds.
#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "evaluate/power_spectrum.h"
#include "evaluate/spectrum_distance.h"
#include "tests/evaluate/sounds.h"

using namespace intaglio;
using namespace intaglio::evaluate;
using namespace intaglio::tests;

namespace {

constexpr double rate = 48000;
constexpr double pi = std::numbers::pi;

Sound decaying(Sound sound, double t60) {
  for (std::size_t n = 0; n < sound.size(); ++n)
    sound[n] = float(double(sound[n]) * std::pow(10, -3 * double(n) / rate / t60));
  return sound;
}

Sound added(Sound one, const Sound& other) {
  for (std::size_t n = 0; n < one.size(); ++n) one[n] += other[n];
  return one;
}

// y(n) = x(n) - x(n - 1), whose power response is 2 - 2 cos(2 pi f / rate).
Sound differenced(const Sound& sound) {
  Sound result = sound;
  for (std::size_t n = 1; n < sound.size(); ++n) result[n] = sound[n] - sound[n - 1];
  return result;
}

}  // namespace

TEST_CASE("a power spectrum adds up to the sum of squares, and has a sine at its frequency") {
  Random random(4);
  std::vector<double> values(100);
  for (double& value : values) value = random.normal();
  const double squares = std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
  for (const std::size_t length : {std::size_t(128), std::size_t(1024)}) {
    PowerSpectrum spectrum(length);
    const auto power = spectrum(values);
    CHECK(power.size() == length / 2 + 1);
    CHECK(std::accumulate(power.begin(), power.end(), 0.0) == doctest::Approx(squares).epsilon(1e-12));
  }
  std::vector<double> sine(64);
  for (std::size_t n = 0; n < sine.size(); ++n) sine[n] = std::sin(2 * pi * 5 * double(n) / 64);
  PowerSpectrum spectrum(64);
  CHECK(spectrum(sine)[5] == doctest::Approx(32));
  CHECK(power_of_two_from(65) == 128);
  CHECK(power_of_two_from(64) == 64);
}

TEST_CASE("sounds that are equal have no spectral distance") {
  const Sound noise = white_noise(0.1, 0.5, 1);
  CHECK(log_spectral_distance(noise, noise, rate) == 0);
  CHECK(std::isnan(log_spectral_distance(Sound(1000, 0.0F), Sound(), rate)));
  CHECK(std::isnan(log_spectral_distance(noise, Sound(), rate, {true, 60})));
}

TEST_CASE("the spectral distance of a sound and the same sound with a gain is the gain in dB, or nothing") {
  // The range is so wide that nothing is cut off at its lower end.
  const Sound noise = white_noise(0.1, 0.5, 2), quiet = scaled(noise, 0.25);
  CHECK(log_spectral_distance(noise, quiet, rate, {false, 300}) == doctest::Approx(12.041).epsilon(1e-4));
  CHECK(log_spectral_distance(quiet, noise, rate, {false, 300}) == doctest::Approx(12.041).epsilon(1e-4));
  CHECK(log_spectral_distance(noise, quiet, rate, {true, 60}) < 1e-4);
  CHECK(log_spectral_distance(noise, scaled(noise, -1), rate) == 0);
}

TEST_CASE("the spectral distance of filtered noise is the root mean square of the filter's response in dB") {
  const double edges[] = {0,    100,  200,  300,  400,  510,  630,  770,  920,  1080, 1270,  1480, 1720,
                          2000, 2320, 2700, 3150, 3700, 4400, 5300, 6400, 7700, 9500, 12000, 15500};
  const Sound noise = white_noise(0.1, 2, 3);
  double squares = 0;
  for (int b = 0; b < 24; ++b) {
    const double w = 2 * pi / rate, low = edges[b], high = edges[b + 1];
    const double power = 2 - 2 * (std::sin(w * high) - std::sin(w * low)) / (w * (high - low));
    squares += std::pow(10 * std::log10(power), 2);
  }
  const double expected = std::sqrt(squares / 24);
  const double found = log_spectral_distance(noise, differenced(noise), rate, {false, 120});
  CHECK(std::abs(found / expected - 1) < 0.03);
}

TEST_CASE("the spectral distance counts silence as the range, and grows with a difference") {
  const Sound noise = white_noise(0.1, 0.5, 5);
  // All cells of noise are near its greatest level, so silence is nearly the whole range away.
  const double to_silence = log_spectral_distance(noise, Sound(), rate, {false, 60});
  CHECK(to_silence > 35);
  CHECK(to_silence < 60);
  double previous = 0;
  for (const double gain : {0.01, 0.1, 1.0}) {
    const double now =
        log_spectral_distance(noise, added(noise, scaled(white_noise(0.1, 0.5, 6), gain)), rate);
    CHECK(now > previous);
    previous = now;
  }
}

TEST_CASE("a decaying tone has its decay time in its band") {
  for (const double t60 : {0.2, 0.5, 1.5})
    for (const int band : {10, 16, 22}) {
      const Sound sound = decaying(tone(third_octave_centre(band), 80, 1.2 * t60), t60);
      CAPTURE(t60);
      CAPTURE(band);
      CHECK(std::abs(decay_times(sound, rate)[std::size_t(band)] / t60 - 1) < 0.02);
    }
}

TEST_CASE("two modes keep their own decay times, and silent bands have none") {
  Sound sound = added(decaying(tone(500, 80, 2), 1.5), decaying(tone(4000, 80, 2), 0.3));
  // A sudden beginning is heard in all bands, so this one takes 20 ms.
  for (std::size_t n = 0; n < 960; ++n) sound[n] *= float(0.5 - 0.5 * std::cos(pi * double(n) / 960));
  const ThirdOctaves times = decay_times(sound, rate);
  CHECK(std::abs(times[13] / 1.5 - 1) < 0.02);
  CHECK(std::abs(times[22] / 0.3 - 1) < 0.02);
  CHECK(std::isnan(times[0]));
  for (const double time : decay_times(Sound(4800, 0.0F), rate)) CHECK(std::isnan(time));
  // A tone that goes on falls at its end only.
  CHECK(std::isnan(decay_times(tone(1000, 80, 0.02), rate)[0]));
}

TEST_CASE("noise that decays has one decay time in all bands that are broad enough") {
  const ThirdOctaves times = decay_times(decaying(white_noise(0.1, 0.8, 8), 0.6), rate);
  for (std::size_t band = 16; band < times.size(); ++band) {
    CAPTURE(band);
    CHECK(std::abs(times[band] / 0.6 - 1) < 0.1);
  }
}

TEST_CASE("the difference of decays is the mean logarithm of their ratio") {
  const Sound noise = white_noise(0.1, 1.5, 9);
  const ThirdOctaves longer = decay_times(decaying(noise, 0.6), rate);
  const ThirdOctaves shorter = decay_times(decaying(noise, 0.5), rate);
  CHECK(decay_difference(longer, longer) == 0);
  CHECK(decay_difference(longer, shorter) == decay_difference(shorter, longer));
  ThirdOctaves scaled_times = longer;
  for (double& time : scaled_times) time *= 1.2;
  CHECK(decay_difference(longer, scaled_times) == doctest::Approx(std::log(1.2)));
  CHECK(std::isnan(decay_difference(longer, decay_times(Sound(), rate))));
}
