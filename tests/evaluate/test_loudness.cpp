// Loudness has the values of ISO 532-1 and of the definitions of sone and phon.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "evaluate/loudness.h"
#include "tests/evaluate/sounds.h"

using namespace intaglio;
using namespace intaglio::evaluate;
using namespace intaglio::tests;

namespace {

// Annex B.2 of ISO 532-1:2017: levels of 28 third octaves and the loudness of this noise in a free field.
constexpr ThirdOctaves machine_noise = {-60, -60, 78, 79, 89, 72, 80, 89, 75, 87, 85, 79, 86, 80,
                                        71,  70,  72, 71, 72, 74, 69, 65, 67, 77, 68, 58, 45, 30};

ThirdOctaves all_bands(double level) {
  ThirdOctaves levels{};
  levels.fill(level);
  return levels;
}

double tone_loudness(double frequency, double level, double rate = 48000) {
  return stationary_loudness(tone(frequency, level, 0.6, rate), rate).sone;
}

double greatest(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end());
}

double relative_error(double value, double expected) {
  return std::abs(value / expected - 1);
}

}  // namespace

TEST_CASE("the loudness of third-octave levels is that of ISO 532-1 and of another implementation") {
  CHECK(relative_error(loudness_of_levels(machine_noise).sone, 83.296) < 1e-4);
  // MoSQITo, commit d990c33, whose results are rounded to 0.001 below 16 sone and to 0.01 above.
  CHECK(std::abs(loudness_of_levels(machine_noise, SoundField::diffuse).sone - 85.57) < 0.0055);
  CHECK(std::abs(loudness_of_levels(all_bands(60)).sone - 31.94) < 0.0055);
  CHECK(std::abs(loudness_of_levels(all_bands(20)).sone - 1.466) < 0.00055);
  const double specific[7][2] = {{4, 5.3272},   {19, 7.5599},  {49, 5.2922}, {99, 2.3498},
                                 {149, 2.5232}, {199, 3.4533}, {229, 0.8047}};
  const Loudness loudness = loudness_of_levels(machine_noise);
  for (const auto& [step, expected] : specific)
    CHECK(std::abs(loudness.specific[std::size_t(step)] - expected) < 6e-5);
}

TEST_CASE("a tone of 1 kHz has 1 sone at 40 dB and twice as many with every 10 dB") {
  CHECK(relative_error(tone_loudness(1000, 40), 1) < 0.003);
  CHECK(relative_error(tone_loudness(1000, 60), 4.019) < 0.001);  // of ISO 532-1, annex B.3
  for (double level = 40; level <= 90; level += 10) {
    CAPTURE(level);
    CHECK(relative_error(tone_loudness(1000, level + 10) / tone_loudness(1000, level), 2) < 0.02);
    CHECK(std::abs(phon_of_sone(tone_loudness(1000, level)) - level) < 0.5);
  }
}

TEST_CASE("tones on a contour of equal loudness are equally loud") {
  // ISO 226:2003's contour of 40 phon. The method follows the edition of 1987, which is 12 dB lower at 100
  // Hz; from 6.3 kHz upward its tones are 6 to 9 phon off that of 2003.
  const double contour[][2] = {{500, 43.05},  {630, 41.34},  {800, 40.06},  {1000, 40.01},
                               {1250, 41.82}, {1600, 42.51}, {2000, 39.23}, {2500, 36.51},
                               {3150, 35.61}, {4000, 36.65}, {5000, 40.01}};
  for (const auto& point : contour) {
    CAPTURE(point[0]);
    CHECK(std::abs(phon_of_sone(tone_loudness(point[0], point[1])) - 40) < 5);
  }
}

TEST_CASE("phon and sone are each other's definition") {
  CHECK(phon_of_sone(1) == doctest::Approx(40));
  CHECK(phon_of_sone(2) == doctest::Approx(50));
  CHECK(phon_of_sone(16) == doctest::Approx(80));
  CHECK(phon_of_sone(0.5) < 40);
}

TEST_CASE("specific loudness adds up to loudness") {
  for (const auto& levels : {machine_noise, all_bands(60), all_bands(20)}) {
    const Loudness loudness = loudness_of_levels(levels);
    double sum = 0;
    for (const double value : loudness.specific) sum += 0.1 * value;
    CHECK(relative_error(sum, loudness.sone) < 0.02);
  }
}

TEST_CASE("loudness grows with the level of any band, and silence has none") {
  CHECK(loudness_of_levels(all_bands(-26)).sone == 0);
  for (std::size_t band = 0; band < std::size_t(third_octave_count); ++band) {
    ThirdOctaves levels = all_bands(50);
    double previous = loudness_of_levels(levels).sone;
    for (levels[band] = 60; levels[band] <= 110; levels[band] += 10) {
      const double now = loudness_of_levels(levels).sone;
      CHECK(now > previous);
      previous = now;
    }
  }
}

TEST_CASE("loudness over time is that of another implementation of ISO 532-1") {
  // MoSQITo, which has the standard's own filters.
  const auto pulse = [](double seconds) {
    return loudness_over_time(between_silence(0.1, tone(1000, 70, seconds), 0.9 - seconds), 48000);
  };
  const LoudnessTrace quick = pulse(0.01), slow = pulse(0.5);
  CHECK(relative_error(greatest(quick.sone), 5.8288) < 0.001);
  CHECK(relative_error(greatest(slow.sone), 8.7945) < 0.001);
  CHECK(relative_error(slow.sone[250], 8.0720) < 0.001);
  CHECK(relative_error(exceeded_loudness(quick, 0.05), 1.3939) < 0.001);
  CHECK(relative_error(exceeded_loudness(slow, 0.05), 8.0795) < 0.001);
  const LoudnessTrace steady = loudness_over_time(tone(250, 80, 1), 48000);
  CHECK(relative_error(steady.sone.back(), 14.6541) < 0.001);
}

TEST_CASE("a longer burst of noise is louder, up to about 200 ms") {
  double previous = 0;
  for (const double seconds : {0.005, 0.02, 0.05, 0.1, 0.2}) {
    const auto noise = between_silence(0.05, white_noise(0.02, seconds, 3), 0.1);
    const double now = greatest(loudness_over_time(noise, 48000).sone);
    CHECK(now > previous);
    previous = now;
  }
  const auto noise = between_silence(0.05, white_noise(0.02, 0.6, 3), 0.1);
  CHECK(relative_error(greatest(loudness_over_time(noise, 48000).sone), previous) < 0.1);
}

TEST_CASE("loudness does not depend on the sign of pressure, on when a sound comes or on the sample rate") {
  const Sound noise = white_noise(0.05, 0.3, 5);
  const auto trace = loudness_over_time(noise, 48000);
  CHECK(loudness_over_time(scaled(noise, -1), 48000).sone == trace.sone);
  const auto later = loudness_over_time(between_silence(0.1, noise, 0), 48000);
  for (std::size_t n = 0; n < trace.sone.size(); ++n)
    CHECK(later.sone[n + 50] == doctest::Approx(trace.sone[n]).epsilon(1e-9));
  for (const double rate : {32000.0, 44100.0, 96000.0}) {
    CAPTURE(rate);
    CHECK(relative_error(tone_loudness(1000, 60, rate), tone_loudness(1000, 60)) < 0.005);
    CHECK(relative_error(tone_loudness(4000, 60, rate), tone_loudness(4000, 60)) < 0.01);
  }
}

TEST_CASE("the distance in loudness is a distance, and that to silence is a sound's own loudness") {
  const auto a = loudness_over_time(tone(1000, 60, 0.5), 48000);
  const auto b = loudness_over_time(tone(1000, 70, 0.5), 48000);
  const auto c = loudness_over_time(tone(4000, 60, 0.4), 48000);
  const auto silence = loudness_over_time({}, 48000);
  CHECK(loudness_distance(a, a) == 0);
  CHECK(loudness_distance(a, c) == loudness_distance(c, a));
  CHECK(loudness_distance(a, c) <= loudness_distance(a, b) + loudness_distance(b, c));
  double sum = 0;
  for (const auto& specific : a.specific)
    for (const double value : specific) sum += 0.1 * value;
  CHECK(loudness_distance(a, silence) == doctest::Approx(sum / double(a.specific.size())));
  // One tone masks a weaker one of the same pitch, so the distance is the difference of loudness.
  CHECK(relative_error(loudness_distance(a, b), 8.04 - 4.019) < 0.05);
  // Tones far apart in pitch do not overlap, so the distance is the sum.
  CHECK(loudness_distance(a, c) > 0.9 * (loudness_distance(a, silence) + 0.8 * 6.1));
  CHECK(loudness_distance(silence, silence) == 0);
}

TEST_CASE("a third-octave band passes its centre and a hundredth of its neighbours' centres") {
  for (const double rate : {36000.0, 44100.0, 48000.0, 96000.0})
    for (int band = 0; band < third_octave_count; band += 3) {
      const auto powers = third_octave_powers(tone(third_octave_centre(band), 94, 1, rate), rate, 0.5);
      const ThirdOctaves levels = third_octave_levels(powers);
      CAPTURE(rate);
      CAPTURE(band);
      CHECK(std::abs(levels[std::size_t(band)] - 94) < 0.05);
      if (band > 0) CHECK(std::abs(levels[std::size_t(band) - 1] - 74) < 0.3);
      if (band + 1 < third_octave_count) CHECK(std::abs(levels[std::size_t(band) + 1] - 74) < 0.3);
    }
}

TEST_CASE("a band that the sample rate does not hold is silent") {
  const ThirdOctaves levels = third_octave_levels(third_octave_powers(white_noise(1, 0.2, 1), 32000));
  CHECK(levels[27] < -25.9);
  CHECK(levels[26] > 60);
}
