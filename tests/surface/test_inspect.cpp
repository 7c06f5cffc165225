#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <numeric>

#include "core/file.h"
#include "surface/import.h"
#include "surface/inspect.h"
#include "tests/temporary_folder.h"

using namespace intaglio;
using namespace intaglio::surface;
namespace fs = std::filesystem;

namespace {

// A grey height map of 64 x 64 from a function of the column.
template <class Height>
fs::path write_columns(const fs::path& path, const Height& height) {
  Image16 image(64, 64, 1);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) image.at(x, y, 0) = std::uint16_t(std::lround(65535 * height(x)));
  }
  REQUIRE(write_file(path, encode_png(image)));
  return path;
}

}  // namespace

TEST_CASE("the slope histogram is a distribution, and a triangle wave has one slope") {
  const tests::TemporaryFolder folder;
  // Up over 32 columns and down again: slope 2 * depth everywhere but at the turns.
  const fs::path path =
      write_columns(folder.path / "t_height.png", [](int x) { return x < 32 ? x / 32.0 : (64 - x) / 32.0; });
  ImportOptions options;
  options.depth_fraction = 0.25;
  const auto inspection = inspect(path, options);
  REQUIRE(inspection);
  CHECK(std::accumulate(inspection->slope_histogram.begin(), inspection->slope_histogram.end(), 0.0) ==
        doctest::Approx(1));
  const double angle = std::atan(0.5) * 180 / 3.14159265358979;  // 26.6 degrees
  CHECK(inspection->slope_histogram[std::size_t(angle / 5)] > 0.9);
  CHECK(inspection->height_levels == 33);
  CHECK(inspection->terrace_slope == doctest::Approx(0.5).epsilon(0.01));
}

TEST_CASE("the advice is a normal map for walls, flat for a plane, relief for gentle slopes") {
  const tests::TemporaryFolder folder;
  ImportOptions options;
  options.depth_fraction = 0.3;
  const auto walls =
      inspect(write_columns(folder.path / "w_height.png", [](int x) { return (x / 8) % 2; }), options);
  REQUIRE(walls);
  CHECK(walls->near_vertical_fraction > 0.1);
  CHECK(walls->representation == "normal");
  const auto plain = inspect(write_columns(folder.path / "p_height.png", [](int) { return 0.5; }), options);
  REQUIRE(plain);
  CHECK(plain->representation == "flat");
  options.depth_fraction = 0.05;
  const auto gentle = inspect(write_columns(folder.path / "g_height.png",
                                            [](int x) { return 0.5 + 0.5 * std::sin(x * 6.283185307 / 32); }),
                              options);
  REQUIRE(gentle);
  CHECK(gentle->representation == "relief");
}

TEST_CASE("an imported surface is written and read back as the same surface") {
  const tests::TemporaryFolder folder;
  BrickRecipe recipe;
  recipe.size = 96;
  const TextureImages brick = make_brick(recipe);
  REQUIRE(write_file(folder.path / "b.png", encode_png(brick.relief)));
  const auto first = import_texture(folder.path / "b.png", {});
  REQUIRE(first);
  REQUIRE(write_texture_files(*first, folder.path / "asset"));
  const auto again = import_texture(folder.path / "asset", {});
  REQUIRE(again);
  CHECK(again->depth_fraction == doctest::Approx(first->depth_fraction).epsilon(0.01));
  CHECK(again->report.polarity == Polarity::depth);
  CHECK(again->report.green == Green::plus_y);
  double depth = 0, normal = 0;
  for (std::size_t k = 0; k < first->texels.depth.size(); ++k) {
    depth = std::max(depth, std::abs(double(first->texels.depth[k] * float(first->depth_fraction) -
                                            again->texels.depth[k] * float(again->depth_fraction))));
    normal = std::max(normal, (first->texels.normal[k] - again->texels.normal[k]).norm());
  }
  MESSAGE("largest change of depth " << depth << " of the side, of the normal " << normal);
  CHECK(depth < 2e-4);
  CHECK(normal < 0.02);
}
