#include <doctest/doctest.h>

#include <cmath>

#include "core/portable_math.h"
#include "sound/model_file.h"
#include "tests/sound/models.h"

using namespace intaglio;
using namespace intaglio::sound;

TEST_CASE("a model written and read is the same model") {
  const auto model = test::small_ball();
  const auto bytes = model_bytes(*model);
  const auto back = parse_model(bytes, "ball.modes");
  REQUIRE(back);
  CHECK(model_bytes(*back) == bytes);
  CHECK(back->name == "ball");
  CHECK(back->material.name == "plastic");
  CHECK(back->angular_frequency == model->angular_frequency);
  CHECK(back->shapes == model->shapes);
  CHECK(back->triangles == model->triangles);
  CHECK(back->mass == model->mass);
  CHECK(back->material.micro.spectral_slope == model->material.micro.spectral_slope);
  std::vector<float> gains(20), gains_back(20);
  model->gains(Vec3(0.01, 0.01, 0.01), Vec3::UnitX(), gains);
  back->gains(Vec3(0.01, 0.01, 0.01), Vec3::UnitX(), gains_back);
  CHECK(gains == gains_back);
}

TEST_CASE("a model file cut off or changed anywhere is a model or one clear error, and never an empty one") {
  const auto bytes = model_bytes(test::model_of({440, 880}, {1, 2}));
  auto model = parse_model(bytes, "a.modes");
  CHECK_FALSE(model);  // no area
  ModalModel good = test::model_of({440, 880}, {1, 2});
  good.area = 0.5;
  const auto whole = model_bytes(good);
  REQUIRE(parse_model(whole, "a.modes"));
  for (std::size_t size = 0; size < whole.size(); size += 3) {
    // What may be missing without a trace is padding at the end.
    if (const auto cut = parse_model(std::span(whole).first(size), "a.modes"))
      CHECK(model_bytes(*cut) == whole);
  }
  CHECK_FALSE(parse_model(std::span(whole).first(whole.size() / 2), "a.modes"));
  for (std::size_t k = 0; k < whole.size(); ++k) {
    for (const int change : {0x01, 0x80, 0xff}) {
      auto changed = whole;
      changed[k] = static_cast<std::uint8_t>(changed[k] ^ change);
      const auto read = parse_model(changed, "a.modes");
      if (read) {
        CHECK(read->modes() > 0);
      } else {
        CHECK(read.error().message().starts_with("a.modes: "));
      }
    }
  }
}

TEST_CASE("a model of another format version is refused, with what to do") {
  // Version 1 had no such number: its place in the table says that it is absent.
  const auto bytes = model_bytes(*test::small_ball());
  int found = 0;
  for (std::size_t k = 4; k + 4 < 200; ++k) {
    auto changed = bytes;
    if (changed[k] != 3 || changed[k + 1] != 0 || changed[k + 2] != 0 || changed[k + 3] != 0) continue;
    changed[k] = 1;
    const auto read = parse_model(changed, "old.modes");
    if (read || read.error().message().find("is of format 1") == std::string::npos) continue;
    ++found;
    CHECK(read.error().message().find("bake it again") != std::string::npos);
  }
  CHECK(found == 1);
}

TEST_CASE("a body too stiff to ring is a model as well: no mode, but a mass and a click") {
  const ModalModel silent = bake(ball(0.005, 1), test::steel(), {"bead", {20, 20, 20'000}}).value();
  CHECK(silent.modes() == 0);
  const auto back = parse_model(model_bytes(silent), "bead.modes");
  REQUIRE(back);
  CHECK(back->modes() == 0);
  CHECK(back->mass == silent.mass);
  CHECK(back->area == silent.area);
}

TEST_CASE(
    "shapes are of 16 bits: a 32,767th of each mode's largest, and rounding them again changes nothing") {
  ModalModel model = *test::small_slab();
  const std::vector<float> rounded = model.shapes;
  round_shapes(model);
  CHECK(model.shapes == rounded);
  Random random(1);
  for (float& x : model.shapes) x = float(random.uniform(-3, 3));
  const std::vector<float> exact = model.shapes;
  round_shapes(model);
  for (std::size_t k = 0; k < exact.size(); ++k) CHECK(std::abs(model.shapes[k] - exact[k]) <= 4.0f / 32768);
  const auto back = parse_model(model_bytes(model), "slab.modes");
  REQUIRE(back);
  CHECK(back->shapes == model.shapes);
}
