#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cmath>
#include <numeric>

#include "sound/impact.h"
#include "sound/modal_bank.h"
#include "sound/modal_model.h"
#include "sound/rubbing.h"
#include "tests/sound/generators.h"
#include "tests/sound/models.h"
#include "tests/sound/samples.h"

using namespace intaglio;
using namespace intaglio::sound;
using test::any_number;
using test::rate;
using test::rms;
using test::tau;

namespace {

// A second of rubbing in steady motion, in steps of 1/480 s.
std::vector<float> steady(Rubbing rubbing, ContactMotion motion, double force = 2) {
  std::vector<float> out(44'100);
  motion.force = force;
  rubbing.begin(0, 0, motion);
  const auto start = motion.relief;
  std::size_t done = 0;
  for (int k = 0; k < 480; ++k) {
    for (std::size_t i = 0; i < 2; ++i)  // on textures of 1 m
      motion.relief[i].uv = start[i].uv + start[i].sweep * (k + 1) / 480;
    rubbing.step(k / 480.0, (k + 1) / 480.0, motion, {true, true});
    const auto end = std::size_t((k + 1) / 480.0 * rate);
    rubbing.sample(std::int64_t(done), 1 / rate, std::span(out).subspan(done, end - done));
    done = end;
  }
  out.resize(done);
  return out;
}

const MicroNoise& fine() {
  static const MicroNoise noise({1e-5, 1e-4, -2.2}, 1);
  return noise;
}
const MicroNoise& coarse() {
  static const MicroNoise noise({5e-5, 4e-4, -2.2}, 2);
  return noise;
}

Rubbing rough(double level_body, double level_other) {
  Rubbing rubbing;
  rubbing.reset({{{&fine(), level_body, 0}, {&coarse(), level_other, 0}}}, 1);
  return rubbing;
}

// Relief 0.5 mm * (1 + cos(2 pi x / wavelength)) / 2 over a square metre.
surface::Surface waves(int count) {
  surface::Texels texels;
  texels.width = texels.height = 1024;
  for (int j = 0; j < 1024; ++j) {
    for (int i = 0; i < 1024; ++i) {
      texels.depth.push_back(float(0.5 - 0.5 * std::cos(tau * count * (i + 0.5) / 1024)));
      texels.normal.push_back(Vec3::UnitZ());
    }
  }
  return {std::move(texels), surface::Placement(Vec3::Zero(), Quat::Identity(), 1, 1), 5e-4,
          surface::Edge::wrap};
}

}  // namespace

TEST_CASE("a dragged body sweeps over the other only, a rolling one over both without slip") {
  const Vec3 v(0.3, 0, 0.4);
  const ContactMotion dragged = contact_motion(v, Vec3::Zero());
  CHECK(dragged.sweep[0] == 0);
  CHECK(dragged.sweep[1] == doctest::Approx(0.5));
  CHECK(dragged.slip == doctest::Approx(0.5));
  const ContactMotion rolling = contact_motion(v, -v);
  CHECK(rolling.sweep[0] == doctest::Approx(0.5));
  CHECK(rolling.sweep[1] == doctest::Approx(0.5));
  CHECK(rolling.slip == 0);
  // Spinning on the spot, and an ideal wheel that slides backwards: each surface is swept by what moves on
  // it.
  const ContactMotion spinning = contact_motion(Vec3::Zero(), v);
  CHECK(spinning.sweep[0] == doctest::Approx(0.5));
  CHECK(spinning.sweep[1] == 0);
  CHECK(spinning.slip == doctest::Approx(0.5));
}

TEST_CASE("sound changes from sliding to rolling without a jump") {
  CHECK(scraped_share(1, 1) == 1);
  CHECK(scraped_share(1, 0) == doctest::Approx(0.25));
  CHECK(scraped_share(0, 1) == 0);
  const Vec3 v(0.4, 0, 0);
  double before = 0, dragged = 0;
  for (int k = 0; k <= 40; ++k) {
    // Only changes excite bodies: the mean does not count.
    std::vector<float> x = steady(rough(1, 1), contact_motion(v, -k / 40.0 * v));
    std::adjacent_difference(x.begin(), x.end(), x.begin());
    const double loudness = rms(x);
    if (k == 0) dragged = loudness;
    if (k > 0) CHECK(std::abs(loudness / before - 1) < 0.1);
    before = loudness;
  }
  CHECK(before > 0.1 * dragged);  // rolling still sounds
}

TEST_CASE("each surface sounds by its own roughness where it is swept") {
  const Vec3 v(0.3, 0, 0);
  // The noise of the swept surface is that of the other body alone, whatever the pen's tip is like.
  CHECK(steady(rough(0, 1), contact_motion(v, Vec3::Zero())) ==
        steady(rough(9, 1), contact_motion(v, Vec3::Zero())));
  const auto both = rms(steady(rough(1, 1), contact_motion(v, -v)));
  const auto one = rms(steady(rough(1, 0), contact_motion(v, -v)));
  const auto other = rms(steady(rough(0, 1), contact_motion(v, -v)));
  CHECK(both == doctest::Approx(std::hypot(one, other)).epsilon(0.1));
}

TEST_CASE("micro noise is linear in the force, and its pitch follows the speed") {
  const auto pitch = [](double speed) {
    // Mean frequency of the noise itself, by zero crossings.
    const std::vector<float> x = steady(rough(0, 1), contact_motion({speed, 0, 0}, Vec3::Zero()));
    int crossings = 0;
    for (std::size_t k = 1; k < x.size(); ++k) crossings += (x[k] > 0) != (x[k - 1] > 0);
    return crossings;
  };
  CHECK(pitch(0.2) == doctest::Approx(2 * pitch(0.1)).epsilon(0.05));
  const ContactMotion motion = contact_motion({0.2, 0, 0}, Vec3::Zero());
  CHECK(rms(steady(rough(0, 1), motion, 6)) ==
        doctest::Approx(3 * rms(steady(rough(0, 1), motion, 2))).epsilon(1e-4));
}

TEST_CASE("without force, motion or contact there is no noise") {
  std::array<float, 64> out;
  Rubbing rubbing = rough(1, 1);
  CHECK_FALSE(rubbing.sample(0, 1 / rate, out));
  ContactMotion still;
  still.force = 5;
  rubbing.begin(0, 0.01, still);
  rubbing.step(0.01, 0.02, still, {true, true});
  CHECK_FALSE(rubbing.sample(441, 1 / rate, out));
  ContactMotion moving = contact_motion({1, 0, 0}, Vec3::Zero());
  moving.force = 5;
  rubbing.step(0.02, 0.03, moving, {true, true});
  CHECK(rubbing.sample(1000, 1 / rate, out));
  rubbing.release();
  CHECK_FALSE(rubbing.sample(1100, 1 / rate, out));
  // After its last step it fades to zero within 30 ms.
  rubbing.begin(0, 0.01, moving);
  rubbing.step(0.01, 0.02, moving, {true, true});
  CHECK(rubbing.sample(std::int64_t(0.0499 * rate), 1 / rate, out));
  CHECK(rms(std::span(out).last(32)) == 0);
  CHECK_FALSE(rubbing.sample(std::int64_t(0.051 * rate), 1 / rate, out));
}

TEST_CASE("relief by height: a sine of v / lambda whose impulses are m times the change of climb") {
  const surface::Surface surface = waves(50);
  Rubbing rubbing;
  rubbing.reset({{{&fine(), 0, 0}, {&fine(), 0, 0}}}, 0.02);
  ContactMotion motion = contact_motion({0.4, 0, 0}, Vec3::Zero());
  motion.relief[1] = {&surface, Vec2::Zero(), {0.4, 0}};
  const std::vector<float> out = steady(rubbing, motion, 50);
  // p_n = m v h'(x): of amplitude m v (2 pi / lambda) a; per sample it changes by 2 pi f dt of that.
  const double f = 0.4 * 50;
  const double amplitude = 0.02 * 0.4 * tau * 50 * 0.25e-3 * tau * f / rate;
  CHECK(rms(out) == doctest::Approx(amplitude / std::sqrt(2)).epsilon(0.02));
  double re = 0, im = 0;
  for (std::size_t k = 0; k < out.size(); ++k) {
    re += out[k] * std::cos(tau * f * double(k) / rate);
    im += out[k] * std::sin(tau * f * double(k) / rate);
  }
  CHECK(2 * std::hypot(re, im) / double(out.size()) == doctest::Approx(amplitude).epsilon(0.02));
  // A contact cannot pull: held down by almost nothing, it is never pushed upwards by more than that.
  const std::vector<float> light = steady(rubbing, motion, 1e-4);
  CHECK(*std::min_element(light.begin(), light.end()) >= -1.001e-4f / float(rate));
}

TEST_CASE("curvature: a ridge, a groove, a plane; radii combine and are bounded") {
  const surface::Surface surface = waves(20);
  const double exact = 0.25e-3 * std::pow(tau * 20, 2);
  // Depth is least at x = 0: a ridge. Mean curvature is half of the only one there is.
  CHECK(relief_curvature(surface, {0, 0.3}, 0) == doctest::Approx(0.5 * exact).epsilon(0.05));
  CHECK(relief_curvature(surface, {0.025, 0.3}, 0) == doctest::Approx(-0.5 * exact).epsilon(0.05));
  CHECK(std::abs(relief_curvature(surface, {0.0125, 0.3}, 0)) < 0.05 * exact);
  CHECK(relief_curvature(surface, {0, 0.3}, 0.05) < 0.2 * exact);
  const double flat = std::numeric_limits<double>::infinity();
  CHECK(contact_radius(0.04, flat) == doctest::Approx(0.04));
  CHECK(contact_radius(0.04, 0.04) == doctest::Approx(0.02));
  CHECK(contact_radius(flat, flat) == doctest::Approx(0.01));
  CHECK(contact_radius(0.04, flat, 75) == doctest::Approx(0.01));
  CHECK(contact_radius(0.04, flat, -1000) == doctest::Approx(0.4));
  CHECK(contact_radius(0.04, flat, 1e9) == doctest::Approx(1e-4));
}

TEST_CASE("Hertz: the patch is that of the closed form") {
  // delta = a^2 / R and F = 4/3 E* sqrt(R) delta^(3/2).
  CHECK(rc::check([] {
    const double force = any_number(1e-3, 1e3), radius = any_number(1e-3, 1), modulus = any_number(1e8, 1e11);
    const double a = hertz_patch_radius(force, radius, modulus), delta = a * a / radius;
    RC_ASSERT(std::abs(4.0 / 3 * modulus * std::sqrt(radius) * std::pow(delta, 1.5) / force - 1) < 1e-9);
  }));
  CHECK(hertz_patch_radius(0, 1, 1e9) == 0);
}

TEST_CASE("acceleration noise: an impulse moves no air in the end; a slow push is rho a^3 / (2 c) dA/dt") {
  const double radius = 0.04, area = 4 * std::numbers::pi * radius * radius;
  const Resonator click = acceleration_noise(area);
  ModalBank bank(std::span(&click, 1), rate);
  const auto play = [&](std::span<const float> velocity_change) {
    std::vector<float> gains(std::size_t(bank.padded_modes()), 0.0f), out(4096, 0.0f);
    gains[0] = 1;
    bank.reset();
    for (std::size_t done = 0; done < out.size(); done += block_samples) {
      const std::array<Drive, 1> drive{{{gains, velocity_change.subspan(done, block_samples), 0}}};
      bank.process(drive, std::span(out).subspan(done, block_samples));
    }
    return out;
  };
  // A(t) = A0 sin(w t) with ka << 1: pressure rho a^3 / (2 c) w A0 cos(w t).
  const double w = tau * 100;
  std::vector<float> slow(4096), blow(4096, 0.0f);
  for (std::size_t k = 0; k < slow.size(); ++k)
    slow[k] = float(std::sin(w * (double(k) + 0.5) / rate) / rate);
  const std::vector<float> far = play(slow);
  const double exact = air_density * std::pow(radius, 3) / (2 * speed_of_sound) * w;
  CHECK(rms(std::span(far).last(2205)) == doctest::Approx(exact / std::sqrt(2)).epsilon(0.15));
  blow[10] = 1;
  const std::vector<float> click_sound = play(blow);
  CHECK(click_sound[9] == 0);
  CHECK(click_sound[10] == doctest::Approx(air_density * speed_of_sound * radius));
  CHECK(acceleration_gain(0.5) == doctest::Approx(2 / std::sqrt(3)));
}
