#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "sound/denormals.h"
#include "sound/modal_bank.h"
#include "tests/count_allocations.h"
#include "tests/sound/models.h"

using namespace intaglio;
using namespace intaglio::sound;
using test::model_of;
using test::rate;
using test::tau;

namespace {

// The bank's output for the drive `impulse` from sample 0 on, all gains 1.
std::vector<float> response(ModalBank& bank, std::span<const float> impulse, std::size_t samples) {
  std::vector<float> gains(std::size_t(bank.padded_modes()), 0.0f), out(samples, 0.0f);
  std::fill_n(gains.begin(), bank.modes(), 1.0f);
  for (std::size_t done = 0; done < samples; done += block_samples) {
    const std::size_t length = std::min<std::size_t>(block_samples, samples - done);
    const std::size_t rest = done < impulse.size() ? std::min(length, impulse.size() - done) : 0;
    const std::array<Drive, 1> drive{{{gains, impulse.subspan(std::min(done, impulse.size()), rest), 0}}};
    bank.process(rest > 0 ? std::span<const Drive>(drive) : std::span<const Drive>(),
                 std::span(out).subspan(done, length));
    bank.sleep_when_silent();
  }
  return out;
}

// Phase in turns that a tone of `hertz` has at the end of a recording, by projection on its last `length`
// samples.
double phase(std::span<const float> x, double hertz, double decay) {
  double re = 0, im = 0;
  for (std::size_t n = 0; n < x.size(); ++n) {
    const double grown = x[n] * std::exp(decay * double(n) / rate);
    re += grown * std::cos(tau * hertz * double(n) / rate);
    im += grown * std::sin(tau * hertz * double(n) / rate);
  }
  return std::atan2(-im, re) / tau;
}

}  // namespace

TEST_CASE("the response to an impulse is the closed form: the velocity of each damped mode") {
  const std::vector<double> hertz{20, 110, 440, 1000, 3333, 10'000, 15'000},
      damping{0.5, 3, 8, 20, 50, 100, 300};
  ModalBank bank(model_of(hertz, damping), rate);
  const float blow = 0.25f;
  const std::vector<float> out = response(bank, std::span(&blow, 1), 44'100);
  double worst = 0;
  for (std::size_t n = 0; n < out.size(); ++n) {
    const double t = double(n) / rate;
    double exact = 0;
    for (std::size_t m = 0; m < hertz.size(); ++m) {
      const double d = damping[m], w = std::sqrt(std::pow(tau * hertz[m], 2) - d * d);
      exact += blow * std::exp(-d * t) * (std::cos(w * t) - d / w * std::sin(w * t));
    }
    worst = std::max(worst, std::abs(out[n] - exact));
  }
  CHECK(worst < 2e-3 * blow * double(hertz.size()));
}

TEST_CASE("T60 is ln 1000 / d") {
  for (const double d : {5.0, 20.0, 200.0}) {
    ModalBank bank(model_of({500}, {d}), rate);
    const float blow = 1;
    response(bank, std::span(&blow, 1), block_samples);
    const double before = bank.energy();
    const auto samples = std::size_t(std::log(1000) / d * rate);
    response(bank, {}, samples);
    // 60 dB less in amplitude is a factor of a million in energy.
    CHECK(10 * std::log10(before / bank.energy()) == doctest::Approx(60).epsilon(1e-2));
  }
}

TEST_CASE("pitch is right to a hundredth of a cent from 20 Hz to 10 kHz") {
  for (const double hertz : {20.0, 100.0, 1000.0, 10'000.0}) {
    const double d = 0.3;
    ModalBank bank(model_of({hertz}, {d}), rate);
    const float blow = 1;
    const std::size_t window = 22'050, seconds = 4;
    const std::vector<float> out = response(bank, std::span(&blow, 1), seconds * 44'100);
    const double exact = std::sqrt(std::pow(tau * hertz, 2) - d * d) / tau;
    const double first = phase(std::span(out).first(window), exact, d);
    const double last = phase(std::span(out).last(window), exact, d);
    const double elapsed = double(out.size() - window) / rate;
    const double expected = exact * elapsed;
    double drift = last - first - (expected - std::floor(expected));
    drift -= std::round(drift);
    const double cents = 1200 * std::log2(1 + drift / elapsed / hertz);
    CAPTURE(hertz);
    CHECK(std::abs(cents) < 0.01);
  }
}

TEST_CASE("energy never rises without a drive, and the final silence is exact") {
  ModalBank bank(*test::small_slab(), rate);
  const float blow = 0.1f;
  response(bank, std::span(&blow, 1), block_samples);
  double before = bank.energy();
  CHECK(before > 0);
  bool rises = false;
  std::array<float, block_samples> out;
  for (int block = 0; block < 4000; ++block) {
    out.fill(0);
    bank.process({}, out);
    rises |= bank.energy() > before;
    before = bank.energy();
    bank.sleep_when_silent();
  }
  CHECK_FALSE(rises);
  CHECK(bank.is_silent());
  CHECK(bank.energy() == 0);
  CHECK(std::all_of(out.begin(), out.end(), [](float x) { return x == 0; }));
}

TEST_CASE("the bank is linear and time-invariant") {
  const auto model = model_of({100, 900, 5000}, {5, 20, 60});
  const std::vector<float> a{1, 0.5f, -0.25f}, b{0, 0, 0.125f, 1};
  std::vector<float> sum{1, 0.5f, -0.125f, 1}, later(130, 0.0f);
  later.insert(later.end(), a.begin(), a.end());
  const auto of = [&](const std::vector<float>& impulse) {
    ModalBank bank(model, rate);
    return response(bank, impulse, 1000);
  };
  const auto x = of(a), y = of(b), both = of(sum), delayed = of(later);
  for (std::size_t n = 0; n < 1000; ++n) CHECK(std::abs(both[n] - x[n] - y[n]) < 1e-5);
  for (std::size_t n = 130; n < 1000; ++n) CHECK(std::abs(delayed[n] - x[n - 130]) < 1e-5);
}

TEST_CASE("modes above the audible range are dropped; an empty bank is silent") {
  CHECK(ModalBank(model_of({1000, 20'900, 21'000, 30'000}, {1, 1, 1, 1}), rate).modes() == 2);
  ModalBank none(model_of({}, {}), rate);
  std::array<float, 8> out{};
  none.process({}, out);
  CHECK(none.is_silent());
}

TEST_CASE("processing does not allocate, and the guard restores the floating-point mode") {
  ModalBank bank(*test::small_slab(), rate);
  std::vector<float> gains(std::size_t(bank.padded_modes()), 0.0f), impulse(block_samples, 0.1f),
      out(block_samples);
  const std::array<Drive, 1> drive{{{gains, impulse, 0}}};
  const std::size_t before = allocations();
  bank.process(drive, out);
  bank.sleep_when_silent();
  CHECK(allocations() == before);
  volatile float tiny = 1e-38f;
  {
    const DenormalsAreZero guard;
#if defined(__SSE2__)
    CHECK(tiny * 0.1f == 0);
#endif
  }
  CHECK(tiny * 0.1f > 0);
}
