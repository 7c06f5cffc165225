#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cmath>
#include <numeric>

#include "sound/contact_step.h"
#include "sound/impact.h"
#include "sound/rubbing.h"
#include "tests/sound/generators.h"
#include "tests/sound/models.h"

using namespace intaglio;
using namespace intaglio::sound;
using test::any_number;
using test::any_vector;

TEST_CASE("Hertz: harder, lighter, faster and blunter contacts are shorter; the clamps hold") {
  const double duration = hertz_contact_duration(0.1, 0.02, 1e9, 1);
  CHECK(duration == doctest::Approx(2.87 * std::pow(0.01 / (0.02 * 1e18), 0.2)));
  CHECK(hertz_contact_duration(0.1, 0.02, 2e9, 1) < duration);
  CHECK(hertz_contact_duration(0.05, 0.02, 1e9, 1) < duration);
  CHECK(hertz_contact_duration(0.1, 0.02, 1e9, 2) < duration);
  CHECK(hertz_contact_duration(0.1, 0.04, 1e9, 1) < duration);
  CHECK(hertz_contact_duration(1e-12, 1, 1e12, 100) == min_contact_duration);
  CHECK(hertz_contact_duration(1e6, 0.001, 1e3, 1e-9) == max_contact_duration);
  CHECK(hertz_contact_duration(0.1, 0.02, 1e9, 0) == max_contact_duration);
  CHECK(effective_modulus(test::steel(), test::steel()) == doctest::Approx(200e9 / (2 * 0.91)));
}

TEST_CASE("the samples of a pulse add up to its impulse, wherever it starts and however it is cut") {
  CHECK(rc::check([] {
    const HalfSine pulse{any_number(0, 0.01), any_number(min_contact_duration, max_contact_duration)};
    const double dt = 1.0 / 44'100;
    std::vector<float> samples(3000), pieces(3000);
    pulse.sample(0, dt, samples);
    for (std::size_t done = 0; done < 3000; done += 60) {
      pulse.sample(double(done) * dt, dt, std::span(pieces).subspan(done, 60));
    }
    const double sum = std::accumulate(samples.begin(), samples.end(), 0.0);
    RC_ASSERT(std::abs(sum - 1) < 1e-5);
    for (std::size_t k = 0; k < 3000; ++k) RC_ASSERT(std::abs(samples[k] - pieces[k]) < 1e-6f);
    for (const float x : samples) RC_ASSERT(x >= 0);
  }));
}

TEST_CASE("a pulse has the peak and the middle of a half-sine") {
  const HalfSine pulse{0.0123, 0.004};
  const double dt = 1e-6;
  std::vector<float> samples(20'000);
  pulse.sample(0, dt, samples);
  double middle = 0, peak = 0;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    middle += (double(k) + 0.5) * dt * samples[k];
    peak = std::max(peak, double(samples[k]) / dt);
  }
  CHECK(middle == doctest::Approx(0.0143).epsilon(1e-4));
  CHECK(peak == doctest::Approx(std::numbers::pi / (2 * 0.004)).epsilon(1e-3));
}

TEST_CASE(
    "a bounce is one onset, a weight at rest is silent, and lifting it off is the opposite of setting it "
    "down") {
  const Vec3 up = Vec3::UnitY();
  ImpulseSplitter bounce;
  CHECK(bounce.split(3 * up) == 3 * up);
  CHECK(bounce.split(Vec3::Zero()) == Vec3::Zero());
  CHECK(bounce.split(Vec3::Zero()) == Vec3::Zero());

  ImpulseSplitter weight;
  CHECK(weight.split(2 * up) == 2 * up);
  for (int k = 0; k < 100; ++k) CHECK(weight.split((2 + 1e-4 * (k % 3)) * up) == Vec3::Zero());
  CHECK((weight.split(Vec3::Zero()) + 2 * up).norm() < 1e-3);

  ImpulseSplitter landing;  // a hard blow, then at rest
  CHECK(landing.split(10 * up) == 10 * up);
  for (int k = 0; k < 10; ++k) CHECK(landing.split(up) == Vec3::Zero());
}

TEST_CASE("onsets scale with the impulses") {
  CHECK(rc::check([] {
    ImpulseSplitter one, three;
    for (int k = 0; k < 20; ++k) {
      const Vec3 impulse = *rc::gen::inRange(0, 4) == 0 ? Vec3(Vec3::Zero()) : any_vector(1);
      RC_ASSERT((three.split(3 * impulse) - 3 * one.split(impulse)).norm() < 1e-9);
    }
  }));
}

TEST_CASE("micro noise: zero mean, unit rms, periodic, the same for the same seed") {
  const MicroRoughness roughness{1e-5, 1e-4, -2.2};
  const MicroNoise noise(roughness, 1), same(roughness, 1), other(roughness, 2);
  double sum = 0, squares = 0, product = 0;
  for (int k = 0; k < MicroNoise::table_size; ++k) {
    const double s = k * noise.spacing();
    sum += noise.sample(s);
    squares += noise.sample(s) * noise.sample(s);
    product += noise.sample(s) * other.sample(s);
    if (k % 1000 == 0) {
      CHECK(noise.sample(s) == same.sample(s));
      CHECK(noise.sample(s + 0.3 * noise.spacing() - 3 * noise.period()) ==
            doctest::Approx(noise.sample(s + 0.3 * noise.spacing())).epsilon(1e-4));
    }
  }
  CHECK(std::abs(sum / MicroNoise::table_size) < 1e-4);
  CHECK(std::sqrt(squares / MicroNoise::table_size) == doctest::Approx(1).epsilon(1e-4));
  CHECK(std::abs(product / MicroNoise::table_size) < 0.1);
}

TEST_CASE("micro noise falls off with the material's spectral slope above one over the correlation length") {
  for (const double slope : {-2.0, -2.8}) {
    const MicroNoise noise({1e-5, 1e-4, slope}, 3);
    // Mean power in an octave of wave numbers (cycles a period), by direct Fourier sums at some of them.
    const auto power = [&](int from, int to) {
      double sum = 0;
      const int stride = (to - from) / 16;
      for (int k = from; k < to; k += stride) {
        double re = 0, im = 0;
        for (int n = 0; n < MicroNoise::table_size; ++n) {
          const double x = noise.sample(n * noise.spacing()),
                       angle = test::tau * double((long(n) * k) % MicroNoise::table_size) /
                               MicroNoise::table_size;
          re += x * std::cos(angle);
          im += x * std::sin(angle);
        }
        sum += re * re + im * im;
      }
      return sum;
    };
    const double corner = noise.period() / (test::tau * 1e-4);
    const int octave = int(4 * corner);
    CHECK(std::log2(power(2 * octave, 4 * octave) / power(octave, 2 * octave)) ==
          doctest::Approx(slope).epsilon(0.05));
    CHECK(std::log2(power(int(corner / 4), int(corner / 2)) / power(int(corner / 8), int(corner / 4))) ==
          doctest::Approx(0).epsilon(0.05));
  }
}

TEST_CASE("the mean over a distance is the mean of the noise, and a long distance averages it out") {
  const MicroNoise noise({1e-5, 1e-4, -2.2}, 4);
  const double h = noise.spacing();
  for (const double length : {1e-4, 0.02, 0.7, 3.3, 47.0}) {
    for (const double start : {0.0, 12.3, -4.7, 1e5}) {
      double mean = 0;
      for (int k = 0; k < 1000; ++k) mean += noise.sample((start + length * (k + 0.5) / 1000) * h) / 1000;
      CHECK(noise.mean(start * h, (start + length) * h) == doctest::Approx(mean).epsilon(2e-3));
    }
  }
  CHECK(std::abs(noise.mean(0, 0.4 * noise.period())) < 0.1);
  CHECK(noise.mean(h, h) == doctest::Approx(noise.sample(h)));
  CHECK(micro_level({1e-5, 1e-4, -2}, 0.5) == doctest::Approx(0.05));
}
