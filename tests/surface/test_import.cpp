#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>

#include "core/file.h"
#include "surface/image/image_file.h"
#include "surface/import.h"
#include "surface/maps.h"
#include "tests/skipped.h"
#include "tests/source_folder.h"
#include "tests/surface/brick_surface.h"
#include "tests/surface/image_encoders.h"
#include "tests/temporary_folder.h"

using namespace intaglio;
using namespace intaglio::surface;
namespace fs = std::filesystem;

namespace {

Image16 channels_of(const Image16& from, int first, int count) {
  Image16 out(from.width, from.height, count);
  for (int y = 0; y < from.height; ++y) {
    for (int x = 0; x < from.width; ++x) {
      for (int c = 0; c < count; ++c) out.at(x, y, c) = from.at(x, y, first + c);
    }
  }
  return out;
}

BrickRecipe small_brick() {
  BrickRecipe recipe;
  recipe.size = 64;
  return recipe;
}

// Root-mean-square difference of two depth maps.
double rms(const std::vector<float>& a, const std::vector<float>& b) {
  REQUIRE(a.size() == b.size());
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(sum / double(a.size()));
}

}  // namespace

TEST_CASE("a PNG round trip keeps every 16-bit sample") {
  const TextureImages brick = make_brick(small_brick());
  const auto decoded = decode_image(encode_png(brick.relief), "x");
  REQUIRE(decoded);
  CHECK(decoded->bit_depth == 16);
  for (std::size_t k = 0; k < brick.relief.data.size(); ++k)
    REQUIRE(std::lround(decoded->pixels.data[k] * 65535.0f) == brick.relief.data[k]);
}

TEST_CASE("an 8-bit sample v is read as v / 255") {
  Image8 image(16, 16, 1);
  for (std::size_t k = 0; k < 256; ++k) image.data[k] = std::uint8_t(k);
  const auto decoded = decode_image(encode_png(image), "x");
  REQUIRE(decoded);
  REQUIRE(decoded->pixels.channels == 1);
  for (std::size_t k = 0; k < 256; ++k)
    CHECK(decoded->pixels.data[k] == doctest::Approx(double(k) / 255).epsilon(1e-6));
}

TEST_CASE("one RGBA file, and the same split into a folder of files, make the same texels") {
  const tests::TemporaryFolder folder;
  const TextureImages brick = make_brick(small_brick());
  REQUIRE(write_file(folder.path / "one" / "wall_nm.png", encode_png(brick.relief)));
  REQUIRE(
      write_file(folder.path / "many" / "wall_NormalGL.png", encode_png(channels_of(brick.relief, 0, 3))));
  REQUIRE(write_file(folder.path / "many" / "wall_Displacement.png",
                     encode_png(channels_of(brick.relief, 3, 1))));
  REQUIRE(write_file(folder.path / "many" / "wall_Color.png", encode_png(brick.colour)));
  ImportOptions options;
  options.polarity = Polarity::depth;
  const auto one = import_texture(folder.path / "one" / "wall_nm.png", options);
  const auto many = import_texture(folder.path / "many", options);
  REQUIRE(one);
  REQUIRE(many);
  CHECK(one->texels.depth == many->texels.depth);
  for (std::size_t k = 0; k < one->texels.normal.size(); ++k)
    CHECK(one->texels.normal[k] == many->texels.normal[k]);
  CHECK(many->texels.colour.width == 64);
}

TEST_CASE("a flipped green channel or an inverted height is detected and corrected, raw and fused") {
  const tests::TemporaryFolder folder;
  const TextureImages brick = make_brick(small_brick());
  const Texels truth = to_texels(brick);
  for (const bool minus : {false, true}) {
    for (const bool high : {false, true}) {
      TextureImages flipped = brick;
      for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
          if (minus) flipped.relief.at(x, y, 1) = std::uint16_t(65535 - flipped.relief.at(x, y, 1));
          if (high) flipped.relief.at(x, y, 3) = std::uint16_t(65535 - flipped.relief.at(x, y, 3));
        }
      }
      REQUIRE(write_file(folder.path / "f.png", encode_png(flipped.relief)));
      for (const auto mode : {surface::ImportMode::raw, surface::ImportMode::fused}) {
        ImportOptions options;
        options.mode = mode;
        const auto imported = import_texture(folder.path / "f.png", options);
        REQUIRE(imported);
        CHECK(imported->report.detected_green == (minus ? Green::minus_y : Green::plus_y));
        CHECK(imported->report.detected_polarity == (high ? Polarity::height : Polarity::depth));
        CHECK(imported->report.implied_depth == doctest::Approx(0.02).epsilon(0.05));
        if (mode == surface::ImportMode::fused) continue;
        CHECK(rms(imported->texels.depth, truth.depth) < 1e-5);
        for (std::size_t k = 0; k < truth.normal.size(); ++k)
          CHECK((imported->texels.normal[k] - truth.normal[k]).norm() < 1e-4);
      }
    }
  }
}

TEST_CASE("options override what is detected") {
  const tests::TemporaryFolder folder;
  const TextureImages brick = make_brick(small_brick());
  REQUIRE(write_file(folder.path / "b.png", encode_png(brick.relief)));
  ImportOptions options;
  options.mode = surface::ImportMode::raw;
  options.green = Green::minus_y;
  options.polarity = Polarity::height;
  const auto imported = import_texture(folder.path / "b.png", options);
  REQUIRE(imported);
  const Texels truth = to_texels(brick);
  CHECK(imported->texels.normal[100].y() == doctest::Approx(-truth.normal[100].y()).epsilon(1e-4));
  CHECK(imported->texels.depth[100] == doctest::Approx(1 - truth.depth[100]).epsilon(1e-4));
}

TEST_CASE("a fused surface is one surface: its normals are the slopes of its depth") {
  const tests::TemporaryFolder folder;
  BrickRecipe recipe;
  recipe.size = 128;
  TextureImages brick = make_brick(recipe);
  Image8 eight(128, 128, 4);
  for (std::size_t k = 0; k < eight.data.size(); ++k) eight.data[k] = std::uint8_t(brick.relief.data[k] >> 8);
  REQUIRE(write_file(folder.path / "b.png", encode_png(eight)));
  const auto imported = import_texture(folder.path / "b.png", {});
  REQUIRE(imported);
  Field height(128, 128);
  for (std::size_t k = 0; k < height.value.size(); ++k) height.value[k] = 1 - imported->texels.depth[k];
  const std::vector<Vec3> of_depth = normals_of(central_slopes(height, imported->depth_fraction));
  double sum = 0;
  for (std::size_t k = 0; k < of_depth.size(); ++k)
    sum += (of_depth[k] - imported->texels.normal[k]).squaredNorm();
  const double error = std::sqrt(sum / double(of_depth.size()));
  MESSAGE("normals against slopes of the depth: rms " << error);
  CHECK(error < 0.01);
}

TEST_CASE("a normal map alone gets an implied depth, of about the right amount") {
  const tests::TemporaryFolder folder;
  const TextureImages brick = make_brick(small_brick());
  REQUIRE(write_file(folder.path / "n.png", encode_png(channels_of(brick.relief, 0, 3))));
  const auto fused = import_texture(folder.path / "n.png", {});
  REQUIRE(fused);
  CHECK(fused->depth_fraction == doctest::Approx(0.02).epsilon(0.15));
  ImportOptions raw;
  raw.mode = surface::ImportMode::raw;
  const auto as_it_is = import_texture(folder.path / "n.png", raw);
  REQUIRE(as_it_is);
  CHECK(as_it_is->texels.depth.empty());
}

TEST_CASE("maps of different surfaces warn and fall back to the height") {
  const tests::TemporaryFolder folder;
  BrickRecipe other = small_brick();
  other.columns = 3;
  other.rows = 10;
  const TextureImages a = make_brick(small_brick());
  const TextureImages b = make_brick(other);
  REQUIRE(write_file(folder.path / "x_normal.png", encode_png(channels_of(a.relief, 0, 3))));
  REQUIRE(write_file(folder.path / "x_height.png", encode_png(channels_of(b.relief, 3, 1))));
  const auto imported = import_texture(folder.path, {});
  REQUIRE(imported);
  CHECK_FALSE(imported->report.detected_green);
  REQUIRE(imported->warnings.size() >= 1);
  CHECK(imported->warnings[0].find("correlation") != std::string::npos);
}

TEST_CASE("a height map alone makes the normals of its slopes") {
  const tests::TemporaryFolder folder;
  const TextureImages brick = make_brick(small_brick());
  REQUIRE(write_file(folder.path / "wall_depth.png", encode_png(channels_of(brick.relief, 3, 1))));
  ImportOptions options;
  options.polarity = Polarity::depth;
  options.depth_fraction = 0.02;
  const auto imported = import_texture(folder.path / "wall_depth.png", options);
  REQUIRE(imported);
  const Texels truth = to_texels(brick);
  double worst = 0;
  for (std::size_t k = 0; k < truth.normal.size(); ++k)
    worst = std::max(worst, (imported->texels.normal[k] - truth.normal[k]).norm());
  CHECK(worst < 1e-3);
}

TEST_CASE("floating-point files may hold heights of any unit and normals of either sign") {
  const tests::TemporaryFolder folder;
  const TextureImages brick = make_brick(small_brick());
  const Texels truth = to_texels(brick);
  Image<float> height(64, 64, 1), normal(64, 64, 3);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      height.at(x, y, 0) = -3 + 8 * (1 - float(brick.relief.at(x, y, 3)) / 65535.0f);
      for (int c = 0; c < 3; ++c) normal.at(x, y, c) = float(brick.relief.at(x, y, c)) / 32767.5f - 1;
    }
  }
  REQUIRE(write_file(folder.path / "w_height.exr", encoders::encode_exr(height)));
  REQUIRE(write_file(folder.path / "w_normal.exr", encoders::encode_exr(normal)));
  ImportOptions options;
  options.mode = surface::ImportMode::raw;
  const auto imported = import_texture(folder.path, options);
  REQUIRE(imported);
  CHECK(imported->report.detected_polarity == Polarity::height);
  CHECK(imported->report.detected_green == Green::plus_y);
  double low = 1, high = 0;
  for (const float d : truth.depth) {
    low = std::min(low, double(d));
    high = std::max(high, double(d));
  }
  for (std::size_t k = 0; k < truth.depth.size(); ++k) {
    CHECK(imported->texels.depth[k] == doctest::Approx((truth.depth[k] - low) / (high - low)).epsilon(1e-4));
    CHECK((imported->texels.normal[k] - truth.normal[k]).norm() < 1e-3);
  }
}

TEST_CASE("broken images are errors that name the file") {
  const tests::TemporaryFolder folder;
  const std::vector<std::uint8_t> png = encode_png(make_brick(small_brick()).relief);
  for (const std::size_t keep :
       {std::size_t{0}, std::size_t{3}, std::size_t{20}, png.size() / 2, png.size() - 20}) {
    const auto decoded = decode_image(std::span(png).first(keep), "broken.png");
    REQUIRE_FALSE(decoded);
    CHECK(decoded.error().message().find("broken.png") == 0);
    CHECK(decoded.error().message().find('\n') == std::string::npos);
  }
  CHECK_FALSE(import_texture(folder.path / "absent.png", {}));
  CHECK_FALSE(import_texture(folder.path, {}));  // an empty folder
}

TEST_CASE("an image larger than the limits is rejected before it is decoded") {
  std::vector<std::uint8_t> png = encode_png(Image8(8, 8, 1));
  png[16] = 0x01;  // width 0x01000008
  CHECK_FALSE(decode_image(png, "huge.png"));
}

TEST_CASE("real textures import") {
  const fs::path shared = fs::path(tests::shared_folder) / "textures";
  if (!fs::exists(shared)) {
    tests::skipped("no real textures in ../shared/textures");
    return;
  }
  for (const char* name : {"brick_medieval_red", "wood_raw_plank", "wood_woodfloor007", "trak4_brick2"}) {
    const auto imported = import_texture(shared / name, {});
    REQUIRE_MESSAGE(imported, name);
    CHECK_MESSAGE(imported->texels.depth.size() == imported->texels.normal.size(), name);
    CHECK_MESSAGE(imported->texels.colour.width > 1, name);
  }
}

TEST_CASE("a built-in name is imported like files: its conventions are detected from its pixels") {
  ImportOptions options;
  options.generated_size = 5;
  CHECK_FALSE(import_texture("brick", options));
  options.generated_size = 128;
  const auto imported = import_texture("stone_flags", options);
  REQUIRE(imported);
  CHECK(imported->texels.width == 128);
  CHECK(imported->report.generated);
  CHECK(imported->report.detected_green == Green::plus_y);
  CHECK(imported->report.detected_polarity == Polarity::depth);
  CHECK(imported->report.correlation > 0.9);
  // The depth that its normals imply is the recipe's.
  CHECK(imported->report.implied_depth == doctest::Approx(imported->depth_fraction).epsilon(0.1));
  const auto unknown = import_texture("stone_flag", {});
  REQUIRE_FALSE(unknown);
  CHECK(unknown.error().message().find("stone_flags") != std::string::npos);
}
