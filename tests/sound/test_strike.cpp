#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "sound/strike.h"
#include "tests/sound/models.h"

using namespace intaglio;
using namespace intaglio::sound;

namespace {

double energy_of(std::span<const float> audio) {
  double sum = 0;
  for (const float x : audio) sum += double(x) * x;
  return sum;
}

std::vector<float> play(const Strike& strike) {
  Synthesizer synthesizer({}, strike_bodies(test::small_slab(), strike));
  synthesizer.push(strike_event(*test::small_slab(), strike, 0.01));
  std::vector<float> out(44'100);
  synthesizer.render(out);
  return out;
}

}  // namespace

TEST_CASE("a strike is on the surface, into it, and has the mallet's impulse") {
  const auto model = test::small_slab();
  Strike strike;
  strike.at = Vec3(0.1, 5, 0.05);
  const ContactEvent event = strike_event(*model, strike, 1);
  CHECK((event.point - Vec3(0.1, 0.015, 0.05)).norm() < 1e-9);
  CHECK((event.n_g - Vec3::UnitY()).norm() < 1e-9);
  CHECK(event.impulse.y() > 0);  // on the mallet: outward
  const double mass = strike.mallet.mass(),
               rebound = 1 + strike.mallet.material.restitution * model->material.restitution;
  CHECK(event.impulse.norm() == doctest::Approx(rebound * mass * model->mass / (mass + model->mass)));
  strike.impulse = 0.5;
  strike.direction = Vec3(0, 0, 2);
  CHECK((strike_event(*model, strike, 1).impulse - Vec3(0, 0, -0.5)).norm() < 1e-12);
}

TEST_CASE("a strike sounds when it should; at a lively point more modes answer than in the middle") {
  const auto model = test::small_slab();
  Strike strike;
  strike.impulse = 0.01;
  const std::vector<float> audio = play(strike);
  CHECK(energy_of(std::span(audio).first(420)) == 0);
  CHECK(energy_of(audio) > 0);
  const auto answering = [&](const Vec3& point) {
    std::vector<float> gains(std::size_t(model->modes()));
    model->gains(point, Vec3::UnitY(), gains);
    return std::count_if(gains.begin(), gains.end(), [](float gain) { return std::abs(gain) > 0.05f; });
  };
  CHECK(answering(default_strike_point(*model)) > answering({0, 0.015, 0}));
}

TEST_CASE("at the default strike point a plate answers in every mode, whatever its orientation" *
          doctest::test_suite("statistics")) {
  for (int across = 0; across < 3; ++across) {
    Vec3 size = Vec3::Constant(0.3);
    size[across] = 0.01;
    Eigen::Vector3i count(8, 8, 8);
    count[across] = 1;
    const ModalModel plate =
        bake(box(size, count.x(), count.y(), count.z()), test::steel(), {"plate", {20, 20, 20'000}}).value();
    std::vector<float> gains(std::size_t(plate.modes()));
    plate.gains(default_strike_point(plate), Vec3::Unit(across), gains);
    float most = 0;
    for (const float g : gains) most = std::max(most, std::abs(g));
    CHECK(std::count_if(gains.begin(), gains.end(), [&](float g) { return std::abs(g) < 1e-3f * most; }) ==
          0);
  }
}

TEST_CASE("a hard mallet sounds brighter than a soft one of the same mass") {
  const auto brightness = [](double youngs_modulus) {
    Strike strike;
    strike.mallet.material.youngs_modulus = youngs_modulus;
    strike.impulse = 0.01;
    const std::vector<float> x = play(strike);
    std::vector<float> difference(x.size() - 1);
    for (std::size_t k = 0; k < difference.size(); ++k) difference[k] = x[k + 1] - x[k];
    return energy_of(difference) / energy_of(x);
  };
  CHECK(brightness(1e10) > 1.5 * brightness(1e7));
}
