#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/portable_math.h"
#include "surface/maps.h"
#include "surface/recipes/noise.h"
#include "tests/skipped.h"
#include "tests/source_folder.h"

using namespace intaglio;
using namespace intaglio::surface;

namespace {

// A random seamless height of n x n texels, 0..1.
Field random_height(int n, std::uint64_t seed) {
  const Fractal noise(4, 4, 4, 0.5, seed);
  Field field(n, n);
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) field.at(x, y) = float(noise((x + 0.5) / n, (y + 0.5) / n));
  }
  const auto [low, high] = std::minmax_element(field.value.begin(), field.value.end());
  const float a = *low, b = *high;
  for (float& v : field.value) v = (v - a) / (b - a);
  return field;
}

Field rounded(Field field, double levels) {
  for (float& v : field.value) v = float(std::round(double(v) * levels) / levels);
  return field;
}

}  // namespace

TEST_CASE("200 flips: green, polarity and rows are found, and the implied depth") {
  Random random(77);
  int right = 0;
  for (int k = 0; k < 200; ++k) {
    const double depth = random.uniform(0.01, 0.06);
    Field height = random_height(96, 1000 + std::uint64_t(k));
    Slopes slopes = central_slopes(height, depth);
    const bool minus = random.uniform() < 0.5, deep = random.uniform() < 0.5,
               upside_down = random.uniform() < 0.3;
    if (minus) negate(slopes.y);
    if (deep) invert(height);
    if (upside_down) flip_rows(height);
    const Detection found = detect_conventions(slopes, rounded(height, 255));
    right += (found.green == Green::minus_y) == minus && (found.polarity == Polarity::depth) == deep &&
                     found.rows_flipped == upside_down && std::abs(found.implied_depth / depth - 1) < 0.1
                 ? 1
                 : 0;
  }
  CHECK(right == 200);
}

TEST_CASE("maps of different surfaces are flagged, and so is a flat height") {
  for (std::uint64_t k = 0; k < 20; ++k) {
    CHECK_FALSE(
        detect_conventions(central_slopes(random_height(96, k), 0.02), random_height(96, 500 + k)).agrees());
  }
  Field flat(96, 96);
  CHECK_FALSE(detect_conventions(central_slopes(random_height(96, 1), 0.02), flat).agrees());
}

TEST_CASE("the conventions of real textures are found") {
  const std::filesystem::path shared = std::filesystem::path(tests::shared_folder) / "textures";
  if (!std::filesystem::exists(shared)) {
    tests::skipped("no real textures in ../shared/textures");
    return;
  }
  const struct {
    std::string path;
    Green green;
  } known[] = {{"brick_medieval_red", Green::plus_y},
               {"wood_raw_plank", Green::plus_y},
               {"wood_woodfloor007", Green::plus_y},
               {"trak4_brick2", Green::minus_y},
               {"wood_woodfloor007/WoodFloor007_1K_NormalGL.png", Green::plus_y},
               {"wood_woodfloor007/WoodFloor007_1K_NormalDX.png", Green::minus_y}};
  for (const auto& texture : known) {
    const auto imported = import_texture(shared / texture.path, {});
    REQUIRE_MESSAGE(imported, texture.path);
    const ImportReport& report = imported->report;
    MESSAGE(texture.path << ": correlation " << report.correlation << " (u " << report.correlation_u << ", v "
                         << report.correlation_v << "), implied depth " << 100 * report.implied_depth
                         << " %, curl " << report.curl << ", lambda " << report.lambda);
    CHECK_MESSAGE(report.detected_green == texture.green, texture.path);
    CHECK_MESSAGE(report.detected_polarity == Polarity::height, texture.path);
    CHECK_MESSAGE(!report.rows_flipped, texture.path);
  }
}
