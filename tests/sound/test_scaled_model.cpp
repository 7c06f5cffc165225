#include <doctest/doctest.h>

#include <cmath>

#include "sound/bake/bake.h"
#include "sound/bake/merge_modes.h"
#include "sound/modal_model.h"
#include "tests/sound/models.h"

using namespace intaglio;
using namespace intaglio::sound;

TEST_CASE("a scaled model is the model of the scaled mesh") {
  const ModalModel small =
      bake(box({0.2, 0.02, 0.1}, 6, 1, 3), test::steel(), {"box", {20, 20, 60'000}}).value();
  for (const double scale : {0.5, 1.0, 3.0}) {
    const ModalModel baked =
        bake(box(scale * Vec3(0.2, 0.02, 0.1), 6, 1, 3), test::steel(), {"box", {20, 1, 600'000}}).value();
    const ModalModel by_scale = scaled(small, scale);
    REQUIRE(by_scale.modes() == baked.modes());
    CHECK(by_scale.mass == doctest::Approx(baked.mass));
    CHECK(by_scale.area == doctest::Approx(baked.area));
    std::vector<float> gains(std::size_t(baked.modes())), expected(gains);
    const Vec3 corner = scale * Vec3(0.1, 0.01, 0.05);
    by_scale.gains(corner, Vec3::UnitY(), gains);
    baked.gains(corner, Vec3::UnitY(), expected);
    for (std::size_t m = 0; m < gains.size(); ++m) {
      CAPTURE(m);
      CHECK(by_scale.angular_frequency[m] == doctest::Approx(baked.angular_frequency[m]).epsilon(1e-6));
      CHECK(by_scale.damping[m] == doctest::Approx(baked.damping[m]).epsilon(1e-6));
      const double loudest = *std::max_element(baked.radiation.begin(), baked.radiation.end());
      CHECK(std::abs(by_scale.radiation[m] - baked.radiation[m]) < 1e-3 * loudest);
      CHECK(std::abs(std::abs(gains[m]) - std::abs(expected[m])) < 2e-3 * std::abs(expected[m]) + 1e-3);
    }
  }
}

TEST_CASE("modes that would no longer ring are left out") {
  Material dull = test::steel();
  dull.rayleigh_alpha = 8000;
  const ModalModel model = bake(box({0.2, 0.02, 0.1}, 6, 1, 3), dull, {"box", {10, 20, 60'000}}).value();
  const ModalModel large = scaled(model, 20);
  CHECK(large.modes() < model.modes());
  CHECK(large.shapes.size() == 3 * large.points.size() * std::size_t(large.modes()));
  for (int m = 0; m < large.modes(); ++m)
    CHECK(large.damping[std::size_t(m)] < large.angular_frequency[std::size_t(m)]);
}

TEST_CASE(
    "scaled by 1 a merged model is as loud as it was: it has the allowance of all that it was merged from") {
  ModalModel merged =
      bake(box({0.3, 0.01, 0.3}, 8, 1, 8), *find_material("ceramic"), {"plate", {40, 20, 20'000}}).value();
  merge_modes(merged, 0.5);
  const ModalModel same = scaled(merged, 1);
  for (std::size_t m = 0; m < merged.radiation.size(); ++m)
    CHECK(same.radiation[m] == doctest::Approx(merged.radiation[m]));
}
