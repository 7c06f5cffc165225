#include "report/spectrogram.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/portable_math.h"
#include "report/svg_plot.h"

using namespace intaglio;
using namespace intaglio::report;

namespace {

std::vector<float> tone(double hz, double sample_rate, std::size_t samples) {
  std::vector<float> audio(samples);
  for (std::size_t k = 0; k < samples; ++k) {
    audio[k] = float(0.5 * std::sin(2 * std::numbers::pi * hz * double(k) / sample_rate));
  }
  return audio;
}

// WCAG relative luminance, 0..1.
double luminance(const Rgb& colour) {
  static constexpr std::array<double, 3> weight = {0.2126, 0.7152, 0.0722};
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double s = colour[c] / 255.0;
    sum += weight[c] * (s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
  }
  return sum;
}

}  // namespace

TEST_CASE("a pure tone peaks at its frequency, in every frame that is full of it") {
  for (const double hz : {110.0, 440.0, 1234.5, 9000.0}) {
    const Spectrogram s = make_spectrogram(tone(hz, 44100, 44100), 44100);
    for (int f = 4; f < s.frames - 4; ++f) {
      const auto frame = s.frame(f);
      const auto peak = std::max_element(frame.begin(), frame.end()) - frame.begin();
      CHECK(std::abs(double(peak) * s.bin_hz() - hz) <= 0.5 * s.bin_hz() + 1e-9);
    }
  }
}

TEST_CASE("Parseval: a spectrogram keeps the energy of its audio") {
  Random random(5);
  for (const std::size_t samples : {std::size_t{100}, std::size_t{2048}, std::size_t{30001}}) {
    std::vector<float> audio(samples);
    for (float& sample : audio) sample = float(0.2 * random.normal());
    double energy = 0, kept = 0;
    for (const float sample : audio) energy += double(sample) * double(sample);
    const Spectrogram s = make_spectrogram(audio, 48000, 1024);
    for (const float power : s.power) kept += double(power) * s.hop();
    CHECK(kept == doctest::Approx(energy).epsilon(1e-4));
  }
}

TEST_CASE("silence and an empty recording are at the floor everywhere") {
  SpectrogramView view;
  for (const std::size_t samples : {std::size_t{0}, std::size_t{44100}}) {
    const Spectrogram s = make_spectrogram(std::vector<float>(samples), 44100);
    for (const float power : s.power) CHECK(level_db(double(power), view.floor_db) == view.floor_db);
    const Image8 image = spectrogram_image(s, view, 40, 30);
    const Rgb floor = magma(0);
    for (std::size_t k = 0; k < image.data.size(); ++k) CHECK(image.data[k] == floor[k % 3]);
  }
}

TEST_CASE("the picture shows a tone in the row of its frequency") {
  SpectrogramView view;
  const double hz = 1000;
  const int height = 200;
  const Image8 image = spectrogram_image(make_spectrogram(tone(hz, 44100, 44100), 44100), view, 50, height);
  const auto brightness = [&](int y) { return image.at(25, y, 0) + image.at(25, y, 1) + image.at(25, y, 2); };
  int brightest = 0;
  for (int y = 0; y < height; ++y) brightest = brightness(y) > brightness(brightest) ? y : brightest;
  const double expected = height * std::log(view.high_hz / hz) / std::log(view.high_hz / view.low_hz);
  CHECK(std::abs(brightest - expected) <= 2);
}

TEST_CASE("samples that are not finite count as silence") {
  std::vector<float> audio = tone(500, 44100, 8192);
  audio[4000] = std::nanf("");
  audio[4001] = HUGE_VALF;
  for (const float power : make_spectrogram(audio, 44100).power) CHECK(std::isfinite(power));
}

TEST_CASE("the colour scales get lighter with every step, from one end to the other, and clamp") {
  for (Rgb (*scale)(double) : {magma, stone}) {
    for (int k = 0; k < 100; ++k) CHECK(luminance(scale((k + 1) / 100.0)) >= luminance(scale(k / 100.0)));
    CHECK(luminance(scale(1)) > luminance(scale(0)) + 0.1);
    CHECK(scale(-3) == scale(0));
    CHECK(scale(7) == scale(1));
    CHECK(scale(std::nan("")) == scale(0));
  }
}
