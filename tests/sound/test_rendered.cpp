// Laws of rendered audio: pitch, decay, silence.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "sound/synthesizer.h"
#include "tests/sound/samples.h"
#include "tests/sound/scenes.h"

using namespace intaglio;
using namespace intaglio::sound;
using test::all_zero;
using test::contact;
using test::rate;
using test::tau;

namespace {

// The sound of a floor of one mode that a silent ball strikes at t = 0.1 s, from the end of the blow on.
std::vector<float> struck(double hertz, double damping, double seconds) {
  std::vector<SoundBody> all = test::bodies();
  all[0].model = std::make_shared<ModalModel>(test::model_of({hertz}, {damping}));
  all[1].model = nullptr;
  Synthesizer synthesizer({}, all);
  // The model of one mode moves along z.
  ContactEvent blow = contact(48, 0, 0, ContactPhase::begin);
  blow.impulse = {0, 0, 5};
  synthesizer.push(blow);
  std::vector<float> out(std::size_t((seconds + 0.11) * rate));
  synthesizer.render(out);
  out.erase(out.begin(), out.begin() + std::ptrdiff_t(0.11 * rate));
  return out;
}

// Amplitude and phase of a tone of `hertz`, of a stretch whose decay is taken out, Hann-windowed.
std::complex<double> tone(std::span<const float> x, double hertz, double damping) {
  std::complex<double> sum = 0;
  for (std::size_t n = 0; n < x.size(); ++n) {
    const double t = double(n) / rate, window = 1 - std::cos(tau * double(n) / double(x.size()));
    sum += window * double(x[n]) * std::exp(damping * t) * std::polar(1.0, -tau * hertz * t);
  }
  return sum / double(x.size());
}

}  // namespace

TEST_CASE("rendered pitch is right within 1 cent from 20 Hz to 15 kHz") {
  double worst = 0;
  for (const double hertz : {20.0, 31.5, 110.0, 440.0, 997.0, 4000.0, 10'000.0, 15'000.0}) {
    const double d = 0.5, exact = std::sqrt(std::pow(tau * hertz, 2) - d * d) / tau;
    const std::vector<float> x = struck(hertz, d, 2);
    // The phase advances by 2 pi f times the time between two stretches.
    const std::size_t length = 22'050, apart = 44'100;
    const auto a = tone(std::span(x).subspan(0, length), exact, d);
    const auto b = tone(std::span(x).subspan(apart, length), exact, d) *
                   std::polar(1.0, -tau * exact * double(apart) / rate);
    const double drift = std::arg(b / a) / tau / (double(apart) / rate);
    const double cents = 1200 * std::log2(1 + drift / exact);
    worst = std::max(worst, std::abs(cents));
    CAPTURE(hertz);
    CHECK(std::abs(cents) < 1);
  }
  MESSAGE("worst: " << worst << " cents");
  CHECK(worst < 0.02);
}

TEST_CASE("rendered decay: T60 is ln 1000 / d within 1 %") {
  double worst = 0;
  for (const double hertz : {200.0, 2000.0, 15'000.0}) {
    for (const double d : {1.0, 7.0, 40.0}) {
      const std::vector<float> x = struck(hertz, d, 4 / d + 0.2);
      const std::size_t length = 4410, apart = std::size_t(3 / d * rate);
      const double exact = std::sqrt(std::pow(tau * hertz, 2) - d * d) / tau;
      const double ratio = std::abs(tone(std::span(x).subspan(apart, length), exact, d)) /
                           std::abs(tone(std::span(x).subspan(0, length), exact, d));
      const double decay = -std::log(ratio) * rate / double(apart);
      const double t60 = std::log(1000) / decay;
      worst = std::max(worst, std::abs(t60 * d / std::log(1000) - 1));
      CAPTURE(hertz);
      CHECK(t60 == doctest::Approx(std::log(1000) / d).epsilon(0.01));
    }
  }
  MESSAGE("worst: " << 100 * worst << " %");
}

TEST_CASE("an impact is not heard as a slide: a bounce with speed along the surface makes no noise") {
  // Bounces, each one step, while the ball flies over rough ground: the same sound with and without micro.
  for (const MesoSource meso : {MesoSource::engine_impulses, MesoSource::normal_map, MesoSource::height}) {
    const auto play = [&](double micro) {
      Synthesizer synthesizer({.meso = meso, .micro_level = micro}, test::bodies());
      for (int k = 10; k < 400; k += 60) {
        synthesizer.push(contact(k, 0.02, 0.8, ContactPhase::begin));
        synthesizer.push(contact(k + 1, 0, 0.8, ContactPhase::end));
      }
      std::vector<float> out(44'100);
      synthesizer.render(out);
      return out;
    };
    CHECK(play(1) == play(0));
  }
}

TEST_CASE("no buzz after sleep: once its events stop, a rolling body is silent as soon as it has rung out") {
  for (const MesoSource meso : {MesoSource::engine_impulses, MesoSource::normal_map, MesoSource::height}) {
    Synthesizer synthesizer({.meso = meso}, test::bodies());
    for (int k = 1; k < 480; ++k) {
      ContactEvent event = contact(k, 0.002, 0.3, k == 1 ? ContactPhase::begin : ContactPhase::persist);
      event.spin = -event.v_t;
      synthesizer.push(event);
    }
    std::vector<float> rolling(44'100), after(4 * 44'100);
    synthesizer.render(rolling);
    synthesizer.render(after);
    CHECK_FALSE(all_zero(std::span(rolling).last(4410)));
    CHECK(all_zero(std::span(after).last(22'050)));
    CHECK(synthesizer.is_silent());
  }
}
