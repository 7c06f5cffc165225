// Every format returns the picture that an independent encoder wrote.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "surface/image/image_file.h"
#include "tests/surface/image_encoders.h"

using namespace intaglio;
using namespace intaglio::surface;
using namespace intaglio::surface::encoders;

namespace {

// Smooth slopes, with flat areas for runs; no symmetry, so that any flip or swap of channels shows.
template <class T>
Image<T> picture(int width, int height, int channels) {
  Image<T> image(width, height, channels);
  const double top = double(std::numeric_limits<T>::max());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) {
        const double slope = std::max(0.0, (x + 0.5 * y) / (width + 0.5 * height) - 0.2);
        image.at(x, y, c) = T(top * (0.1 + 0.2 * c + (c == 1 ? 0.5 * y / height : 0.3 * slope)));
      }
    }
  }
  return image;
}

template <class T>
Image<float> scaled(const Image<T>& image) {
  Image<float> out(image.width, image.height, image.channels);
  std::transform(image.data.begin(), image.data.end(), out.data.begin(),
                 [](T v) { return float(v) / float(std::numeric_limits<T>::max()); });
  return out;
}

DecodedImage decoded(const File& file, const std::string& name = "x") {
  auto image = decode_image(file, name);
  if (!image) FAIL(image.error().message());
  return std::move(*image);
}

double difference(const Image<float>& a, const Image<float>& b) {
  REQUIRE(a.width == b.width);
  REQUIRE(a.height == b.height);
  REQUIRE(a.channels == b.channels);
  double worst = 0;
  for (std::size_t k = 0; k < a.data.size(); ++k)
    worst = std::max(worst, double(std::abs(a.data[k] - b.data[k])));
  return worst;
}

}  // namespace

TEST_CASE("PNG: samples of 8 and 16 bits become correctly rounded fractions") {
  for (const int channels : {1, 3, 4}) {
    const auto image8 = picture<std::uint8_t>(37, 23, channels);
    const auto image16 = picture<std::uint16_t>(37, 23, channels);
    const DecodedImage of8 = decoded(encode_png(image8)), of16 = decoded(encode_png(image16));
    CHECK(of8.bit_depth == 8);
    CHECK(of16.bit_depth == 16);
    CHECK(difference(of8.pixels, scaled(image8)) == 0);
    CHECK(difference(of16.pixels, scaled(image16)) == 0);
    CHECK_FALSE(of8.rows_flipped_in_file);
  }
}

TEST_CASE("PNG: samples of 1, 2 and 4 bits, and a palette") {
  for (const int bits : {1, 2, 4}) {
    const int top = (1 << bits) - 1;
    File row{0};
    Image<float> truth(16, 1, 1);
    for (int x = 0; x < 16; ++x) {
      const int value = (x * 5 + 1) % (top + 1);
      if (x * bits % 8 == 0) row.push_back(0);
      row.back() = std::uint8_t(row.back() | value << (8 - bits - x * bits % 8));
      truth.at(x, 0, 0) = float(value) / float(top);
    }
    const File end = png_idat(row) + png_chunk("IEND", {});
    const DecodedImage grey = decoded(png_signature() + png_ihdr({16, 1, std::uint8_t(bits), 0}) + end);
    CHECK(difference(grey.pixels, truth) == 0);
    CHECK(grey.bit_depth == 8);
    File palette;
    for (int k = 0; k <= top; ++k)
      palette = palette + File{std::uint8_t(k), std::uint8_t(k + 1), std::uint8_t(k + 2)};
    const DecodedImage coloured = decoded(png_signature() + png_ihdr({16, 1, std::uint8_t(bits), 3}) +
                                          png_chunk("PLTE", palette) + end);
    REQUIRE(coloured.pixels.channels == 3);
    for (int x = 0; x < 16; ++x) {
      const float index = std::round(truth.at(x, 0, 0) * float(top));
      CHECK(coloured.pixels.at(x, 0, 2) == (index + 2) / 255.0f);
    }
  }
}

TEST_CASE("PNG: an interlaced picture is the plain one") {
  constexpr int x0[] = {0, 4, 0, 2, 0, 1, 0}, y0[] = {0, 0, 4, 0, 2, 0, 1};
  constexpr int dx[] = {8, 8, 4, 4, 2, 2, 1}, dy[] = {8, 8, 8, 4, 4, 2, 2};
  for (const int width : {1, 3, 8, 21}) {
    const auto image = picture<std::uint8_t>(width, 13, 3);
    File rows;
    for (int pass = 0; pass < 7; ++pass) {
      for (int y = y0[pass]; y < image.height && x0[pass] < width; y += dy[pass]) {
        rows.push_back(0);
        for (int x = x0[pass]; x < width; x += dx[pass]) {
          for (int c = 0; c < 3; ++c) rows.push_back(image.at(x, y, c));
        }
      }
    }
    const File file = png_signature() + png_ihdr({std::uint32_t(width), 13, 8, 2, 1}) + png_idat(rows) +
                      png_chunk("IEND", {});
    CHECK(difference(decoded(file).pixels, scaled(image)) == 0);
  }
}

TEST_CASE("TGA: all four origins, raw and run-length, grey, RGB and RGBA give the same picture") {
  for (const int channels : {1, 3, 4}) {
    const auto image = picture<std::uint8_t>(150, 11, channels);
    for (int bits = 0; bits < 16; ++bits) {
      TgaLayout layout{(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0};
      if ((bits & 8) != 0) layout.id = "an id of some bytes";
      const DecodedImage got = decoded(encode_tga(image, layout));
      CHECK(difference(got.pixels, scaled(image)) == 0);
      CHECK(got.rows_flipped_in_file == !layout.top_down);
      CHECK(got.bit_depth == 8);
    }
  }
}

TEST_CASE("TGA: runs may cross the ends of rows") {
  Image8 flat(10, 9, 3);
  std::fill(flat.data.begin(), flat.data.end(), std::uint8_t{200});
  const File file = encode_tga(flat, {true});
  CHECK(file.size() == 18 + 4);
  CHECK(difference(decoded(file).pixels, scaled(flat)) == 0);
}

TEST_CASE("TGA: alpha is kept when the header claims none, and a colour map is skipped") {
  const auto image = picture<std::uint8_t>(9, 5, 4);
  TgaLayout layout;
  layout.alpha_bits = 0;
  File file = encode_tga(image, layout);
  CHECK(difference(decoded(file).pixels, scaled(image)) == 0);
  file[1] = 1;  // a map of 3 entries of 24 bits
  file[5] = 3;
  file[7] = 24;
  file.insert(file.begin() + 18, 9, std::uint8_t{77});
  CHECK(difference(decoded(file).pixels, scaled(image)) == 0);
}

TEST_CASE("EXR: floats are read unchanged, whatever the compression, tiles and window") {
  for (const int channels : {1, 3, 4}) {
    auto image = scaled(picture<std::uint16_t>(45, 37, channels));
    for (std::size_t k = 0; k < image.data.size(); k += 7) image.data[k] = 100 * image.data[k] - 20;
    for (const auto compression : {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION,
                                   Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
      for (const bool tiled : {false, true}) {
        ExrLayout layout;
        layout.compression = compression;
        layout.tiled = tiled;
        layout.left = -1000;
        layout.top = tiled ? 123456 : -7;
        const DecodedImage got = decoded(encode_exr(image, layout));
        CHECK(difference(got.pixels, image) == 0);
        CHECK(got.bit_depth == 32);
      }
    }
  }
}

TEST_CASE("EXR: halves are exact with lossless compression and close with lossy") {
  const auto image = scaled(picture<std::uint16_t>(45, 37, 3));
  for (const auto compression :
       {Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION, Imf::PXR24_COMPRESSION, Imf::B44_COMPRESSION,
        Imf::B44A_COMPRESSION, Imf::DWAA_COMPRESSION, Imf::DWAB_COMPRESSION}) {
    ExrLayout layout;
    layout.compression = compression;
    layout.half = true;
    const DecodedImage got = decoded(encode_exr(image, layout));
    CHECK(got.bit_depth == 16);
    const bool lossy = compression >= Imf::B44_COMPRESSION;
    CHECK(difference(got.pixels, image) < (lossy ? 0.03 : 1.0 / 2048));
  }
}

TEST_CASE("EXR: one channel of any name is grey; Y A is grey with alpha; others are named in the error") {
  const auto grey = scaled(picture<std::uint16_t>(20, 10, 1));
  for (const char* name : {"Z", "height", "displacement.Y", "A"}) {
    ExrLayout layout;
    layout.channels = {name};
    CHECK(difference(decoded(encode_exr(grey, layout)).pixels, grey) == 0);
  }
  const auto two = scaled(picture<std::uint16_t>(20, 10, 2));
  ExrLayout layout;
  layout.channels = {"Y", "A"};
  const DecodedImage got = decoded(encode_exr(two, layout));
  REQUIRE(got.pixels.channels == 4);
  for (int c = 0; c < 4; ++c) CHECK(got.pixels.at(7, 3, c) == two.at(7, 3, c == 3 ? 1 : 0));
  layout.channels = {"u", "v"};
  const auto refused = decode_image(encode_exr(two, layout), "uv.exr");
  REQUIRE_FALSE(refused);
  CHECK(refused.error().message().find("u, v") != std::string::npos);
}

TEST_CASE(
    "EXR: irrelevant attributes are skipped, and a pixel that is not finite is an error with its place") {
  auto image = scaled(picture<std::uint16_t>(20, 10, 3));
  ExrLayout layout;
  layout.preview = true;
  CHECK(difference(decoded(encode_exr(image, layout)).pixels, image) == 0);
  image.at(13, 4, 1) = std::numeric_limits<float>::quiet_NaN();
  const auto nan = decode_image(encode_exr(image), "nan.exr");
  REQUIRE_FALSE(nan);
  CHECK(nan.error().message().find("nan.exr: the pixel in column 13, row 4") == 0);
}

TEST_CASE("the same picture is equal in all formats, within their precision") {
  for (const int channels : {1, 3}) {
    const auto image = picture<std::uint8_t>(64, 48, channels);
    const Image<float> truth = scaled(image);
    CHECK(difference(decoded(encode_png(image)).pixels, truth) == 0);
    CHECK(difference(decoded(encode_tga(image, {true})).pixels, truth) == 0);
    CHECK(difference(decoded(encode_exr(truth)).pixels, truth) == 0);
    ExrLayout layout;
    layout.half = true;
    CHECK(difference(decoded(encode_exr(truth, layout)).pixels, truth) <= 1.0 / 4096);
    CHECK(difference(decoded(encode_jpeg(image)).pixels, truth) <= 3.0 / 255);
    CHECK(difference(decoded(encode_jpeg(image, 100, true)).pixels, truth) <= 3.0 / 255);
  }
}

TEST_CASE("the caller's limits apply") {
  const auto image = picture<std::uint8_t>(40, 30, 3);
  for (const File& file :
       {encode_png(image), encode_jpeg(image), encode_tga(image), encode_exr(scaled(image))}) {
    CHECK(decode_image(file, "x", {40, 1200}));
    CHECK_FALSE(decode_image(file, "x", {39, 1200}));
    CHECK_FALSE(decode_image(file, "x", {40, 1199}));
  }
}

TEST_CASE("extensions of images are recognised in any case") {
  for (const char* name : {"a.png", "a.JPG", "b.jpeg", "c.Tga", "d.EXR"}) CHECK(has_image_extension(name));
  for (const char* name : {"a.txt", "png", "a.png.zip", ""}) CHECK_FALSE(has_image_extension(name));
}
