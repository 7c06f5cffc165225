// FLIP agrees with its published implementation, and obeys the laws of a difference.
#include <doctest/doctest.h>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/file.h"
#include "core/portable_math.h"
#include "evaluate/flip.h"
#include "surface/image/image_file.h"
#include "tests/skipped.h"
#include "tests/source_folder.h"

using namespace intaglio;
using namespace intaglio::evaluate;

namespace {
Image8 constant(int r, int g, int b) {
  Image8 picture(40, 24, 3);
  for (std::size_t k = 0; k < picture.data.size(); k += 3) {
    picture.data[k] = std::uint8_t(r);
    picture.data[k + 1] = std::uint8_t(g);
    picture.data[k + 2] = std::uint8_t(b);
  }
  return picture;
}

// A pattern with ramps, texture and squares; `changed` inverts a part, adds coloured lines and dims another.
Image8 pattern(bool changed) {
  Image8 picture(72, 56, 3);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      for (int c = 0; c < 3; ++c) {
        const int ramp = (5 * x + 3 * y + 60 * c) % 256, texture = (x * x + 3 * y * y + x * y) % 29 * 4;
        int value = (2 * ramp + texture + ((x / 6 + y / 6) % 2 ? 70 : 0)) / 3;
        if (changed && x >= 20 && x < 44 && y >= 12 && y < 40) value = 255 - value;
        if (changed && (x + 2 * y) % 7 == 0) value += 25 - 10 * c;
        if (changed && y > 44) value = value * (200 - x) / 200;
        picture.at(x, y, c) = std::uint8_t(std::clamp(value, 0, 255));
      }
  return picture;
}

Image8 noise(std::uint64_t seed, int width, int height) {
  Random random(seed);
  Image8 picture(width, height, 3);
  for (auto& sample : picture.data) sample = std::uint8_t(random.uniform(0, 256));
  return picture;
}

// Vertical bars of 16 pixels, moved by `shift`.
Image8 bars(int shift) {
  Image8 picture(128, 32, 3);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      for (int c = 0; c < 3; ++c) picture.at(x, y, c) = (x + 32 - shift) % 32 < 16 ? 200 : 60;
  return picture;
}

double flip_mean(const Image8& a, const Image8& b, double pixels_per_degree = default_pixels_per_degree) {
  return flip(a, b, pixels_per_degree).value().mean;
}

}  // namespace

TEST_CASE("FLIP of a pattern is what its published implementation computes") {
  // Computed in single precision by FLIP.h of github.com/NVlabs/flip, commit 1eb247c.
  const struct {
    double pixels_per_degree, mean, pixels[6];
  } expected[] = {
      {default_pixels_per_degree, 0.3315229, {0.152383, 0.975429, 0.465195, 0.441919, 0.076374, 0.657988}},
      {30, 0.3147598, {0.233529, 0.979351, 0.435076, 0.375825, 0.058992, 0.511404}},
      {120, 0.3476311, {0.121269, 0.969777, 0.522347, 0.455931, 0.086991, 0.653772}}};
  const int places[6][2] = {{0, 0}, {30, 20}, {71, 55}, {40, 50}, {10, 10}, {44, 30}};
  for (const auto& test : expected) {
    const FlipMap map = flip(pattern(false), pattern(true), test.pixels_per_degree).value();
    CAPTURE(test.pixels_per_degree);
    CAPTURE(map.mean);
    CHECK(std::abs(map.mean - test.mean) < 1e-6);
    for (int k = 0; k < 6; ++k)
      CHECK(std::abs(double(map.error.at(places[k][0], places[k][1], 0)) - test.pixels[k]) < 1e-5);
  }
}

TEST_CASE("FLIP of uniform colours is their remapped HyAB distance") {
  // By an independent transcription of the formulas in double precision. Black and white are 100 apart, so
  // theirs is 0.95 + 0.05 (100^0.7 / g - 0.4) / 0.6, g being the 0.7th power of green's distance from blue.
  // The published implementation is up to 4e-5 off here: rounding in single precision becomes a feature.
  const auto close = [](double value) { return doctest::Approx(value).epsilon(1e-7); };
  CHECK(flip_mean(constant(0, 0, 0), constant(255, 255, 255)) == close(0.9673798));
  CHECK(flip_mean(constant(0, 255, 0), constant(0, 0, 255)) == close(1));
  CHECK(flip_mean(constant(255, 0, 0), constant(0, 255, 0)) == close(0.9866623));
  CHECK(flip_mean(constant(128, 128, 128), constant(140, 140, 140)) == close(0.1691082));
  CHECK(flip_mean(constant(10, 20, 200), constant(10, 30, 180)) == close(0.2058256));
}

TEST_CASE("FLIP of the published pair of pictures is the published mean") {
  const auto folder = std::filesystem::path(tests::shared_folder) / "flip";
  std::error_code none;
  if (!std::filesystem::exists(folder / "reference.png", none) ||
      !std::filesystem::exists(folder / "test.png", none))
    return tests::skipped("the pictures of github.com/NVlabs/flip are not in " + folder.string());
  const auto picture = [&](const char* name) {
    const auto decoded = surface::read_image(folder / name).value();
    Image8 bytes(decoded.pixels.width, decoded.pixels.height, decoded.pixels.channels);
    for (std::size_t k = 0; k < bytes.data.size(); ++k)
      bytes.data[k] = std::uint8_t(std::lround(decoded.pixels.data[k] * 255));
    return bytes;
  };
  // Published means are of single precision.
  CHECK(std::abs(flip_mean(picture("reference.png"), picture("test.png")) - 0.159691) < 2e-5);
}

TEST_CASE("FLIP of a picture with itself is zero at every pixel") {
  const FlipMap map = flip(noise(1, 50, 30), noise(1, 50, 30)).value();
  CHECK(map.mean == 0);
  CHECK(*std::max_element(map.error.data.begin(), map.error.data.end()) == 0);
}

TEST_CASE("FLIP is symmetric, ignores alpha and stays between 0 and 1") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Image8 a = noise(seed, 33, 21), b = noise(seed + 100, 33, 21);
    const FlipMap map = flip(a, b).value(), other = flip(b, a).value();
    CHECK(map.error.data == other.error.data);
    const auto [least, most] = std::minmax_element(map.error.data.begin(), map.error.data.end());
    CHECK(*least >= 0);
    CHECK(*most <= 1);
    Image8 with_alpha(33, 21, 4);
    for (int y = 0; y < 21; ++y)
      for (int x = 0; x < 33; ++x) {
        for (int c = 0; c < 3; ++c) with_alpha.at(x, y, c) = b.at(x, y, c);
        with_alpha.at(x, y, 3) = std::uint8_t(7 * x);
      }
    CHECK(flip(a, with_alpha).value().error.data == map.error.data);
  }
}

// Near half a period edges lie on edges of the other sign, whose magnitudes agree.
TEST_CASE("FLIP grows as a pattern moves further, up to three eighths of its period") {
  double previous = 0;
  for (int shift = 1; shift <= 12; ++shift) {
    const double now = flip_mean(bars(0), bars(shift));
    CAPTURE(shift);
    CHECK(now > previous);
    previous = now;
  }
}

TEST_CASE("FLIP sees less of fine noise from further away") {
  const Image8 grey = constant(128, 128, 128);
  Image8 noisy = grey;
  Random random(9);
  for (auto& sample : noisy.data) sample = std::uint8_t(128 + (random.uniform() < 0.5 ? -20 : 20));
  CHECK(flip_mean(grey, noisy, 30) > flip_mean(grey, noisy, 67));
  CHECK(flip_mean(grey, noisy, 67) > flip_mean(grey, noisy, 200));
}

TEST_CASE("FLIP of pictures that do not match is an error") {
  CHECK(flip(noise(1, 8, 8), noise(1, 8, 9)).error().what == "the pictures have 8 x 8 and 8 x 9 pixels");
  CHECK(!flip(Image8(), Image8()));
  CHECK(!flip(Image8(4, 4, 1), Image8(4, 4, 1)));
  CHECK(!flip(noise(1, 8, 8), noise(2, 8, 8), 0));
  CHECK(!flip(noise(1, 8, 8), noise(2, 8, 8), std::nan("")));
}

TEST_CASE("the default pixels per degree are those of a 0.7 m display of 3840 pixels seen from 0.7 m") {
  CHECK(pixels_per_degree_of(0.7, 3840, 0.7) == doctest::Approx(default_pixels_per_degree).epsilon(1e-12));
}
