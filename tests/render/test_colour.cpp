// Colours on the GPU are the image's, and coarser levels its mean light.
#include "render/surface_textures.h"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <array>
#include <cmath>

namespace intaglio::render::test {

namespace {

double linear(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

std::array<double, 3> light_of(std::uint32_t texel) {
  std::array<double, 3> out;
  for (int c = 0; c < 3; ++c)
    out[std::size_t(c)] = std::ldexp(double(texel >> (9 * c) & 511), int(texel >> 27) - 24);
  return out;
}

}  // namespace

TEST_CASE("each 8-bit colour differs from its neighbours and is within half a step of itself") {
  Image8 image(256, 1, 3);
  for (int k = 0; k < 256; ++k)
    for (int c = 0; c < 3; ++c) image.at(k, 0, c) = std::uint8_t(k);
  const auto texels = colour_levels(image).front().texels;
  for (int k = 0; k < 256; ++k) {
    const double kept = light_of(texels[std::size_t(k)])[0];
    CHECK(kept > linear((k - 0.5) / 255));
    CHECK(kept < linear((k + 0.5) / 255));
  }
}

TEST_CASE("levels halve down to one texel, and each level has the mean light of the image") {
  CHECK(rc::check([] {
    Image8 image(*rc::gen::inRange(1, 40), *rc::gen::inRange(1, 40), 3);
    image.data =
        *rc::gen::container<std::vector<std::uint8_t>>(image.data.size(), rc::gen::arbitrary<std::uint8_t>());
    const auto levels = colour_levels(image);
    double whole = 0;
    for (const std::uint8_t k : image.data) whole += linear(k / 255.0) / double(image.data.size());
    int width = image.width, height = image.height;
    for (const ColourLevel& level : levels) {
      RC_ASSERT(level.width == width && level.height == height);
      RC_ASSERT(level.texels.size() == std::size_t(width * height));
      double sum = 0;
      for (const std::uint32_t texel : level.texels)
        for (const double x : light_of(texel)) sum += x / (3.0 * double(level.texels.size()));
      RC_ASSERT(std::abs(sum - whole) < 1.0 / 512);
      width = std::max(width / 2, 1);
      height = std::max(height / 2, 1);
    }
    RC_ASSERT(levels.back().texels.size() == 1u);
  }));
}

}  // namespace intaglio::render::test
