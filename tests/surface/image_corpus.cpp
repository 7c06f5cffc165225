#include "tests/surface/image_corpus.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

namespace intaglio::surface::corpus {

using namespace encoders;

Image8 small_picture(int channels) {
  Image8 image(24, 17, channels);
  for (std::size_t k = 0; k < image.data.size(); ++k) image.data[k] = std::uint8_t(k % 97 < 50 ? 9 : k * 7);
  return image;
}

Image<float> small_floats(int channels) {
  const Image8 image = small_picture(channels);
  Image<float> out(image.width, image.height, channels);
  std::copy(image.data.begin(), image.data.end(), out.data.begin());
  return out;
}

void add_damaged(Corpus& corpus, const std::string& name, const File& good) {
  for (std::size_t k = 0; k < 16; ++k) {
    const std::size_t keep = k < 8 ? k * good.size() / 8 : good.size() - (std::size_t{1} << (k - 8));
    if (keep >= good.size()) continue;
    corpus.push_back(
        {fmt::format("cut at {} {}", keep, name), File(good.begin(), good.begin() + std::ptrdiff_t(keep))});
  }
  for (std::size_t at = 0; at < std::min<std::size_t>(good.size(), 400); at += 3) {
    File flipped = good;
    flipped[at] = std::uint8_t(flipped[at] ^ 1u << at % 8);
    corpus.push_back({fmt::format("bit flipped at {} {}", at, name), flipped, Expect::anything});
  }
}

void add_png(Corpus& corpus) {
  const File rows(17 * 25, 0), idat = png_idat(rows), end = png_chunk("IEND", {});
  const auto png = [&](const std::string& name, const File& chunks) {
    corpus.push_back({name + ".png", png_signature() + chunks});
  };
  const auto with = [&](const std::string& name, const PngHeader& header) {
    png(name, png_ihdr(header) + idat + end);
  };
  with("zero width", {0, 17, 8, 0});
  with("zero height", {24, 0, 8, 0});
  with("one column too many", {16385, 1, 8, 0});
  with("one row too many", {1, 16385, 8, 0});
  with("more than 64 Mpx", {16384, 16384, 8, 0});
  with("2 gigapixels wide", {0x7fffffff, 0x7fffffff, 16, 6});
  with("negative", {0xffffffff, 0xffffffff, 8, 0});
  with("large and empty", {8192, 8192, 16, 6});
  with("3 bits", {24, 17, 3, 0});
  with("colour type 5", {24, 17, 8, 5});
  with("palette without PLTE", {24, 17, 8, 3});
  with("too few rows", {24, 18, 8, 0});
  const File ihdr = png_ihdr({24, 17, 8, 0});
  png("only the signature", {});
  png("data before header", idat + ihdr + end);
  png("no data", ihdr + end);
  png("no end", ihdr + idat);
  png("two headers", ihdr + ihdr + idat + end);
  png("unknown critical chunk", ihdr + png_chunk("ABCD", {1, 2, 3}) + idat + end);
  png("data is not deflate", ihdr + png_chunk("IDAT", File(50, 0xee)) + end);
  png("empty data", ihdr + png_chunk("IDAT", {}) + end);
  File long_chunk = ihdr + idat + end;
  long_chunk[ihdr.size()] = 0x7f;
  png("chunk longer than the file", long_chunk);
  for (const std::size_t at :
       {ihdr.size() - 1, ihdr.size() + idat.size() - 1, ihdr.size() + idat.size() + end.size() - 1}) {
    File wrong = ihdr + idat + end;
    wrong[at] ^= 1;
    png(fmt::format("wrong checksum at {}", at), wrong);
  }
}

void add_jpeg(Corpus& corpus) {
  const File good = encode_jpeg(small_picture(3));
  constexpr std::array marker{0xff, 0xc0};
  const auto frame = std::search(good.begin(), good.end(), marker.begin(), marker.end());
  const auto size_at = std::size_t(frame - good.begin()) + 5;
  const auto sized = [&](const std::string& name, std::uint8_t high, std::uint8_t low) {
    File file = good;
    for (const std::size_t at : {size_at, size_at + 2}) {
      file[at] = high;
      file[at + 1] = low;
    }
    corpus.push_back({name + ".jpg", file});
  };
  sized("zero size", 0, 0);
  sized("65500 square", 0xff, 0xdc);
  sized("16385 square", 0x40, 0x01);
  sized("16384 square", 0x40, 0x00);
  sized("4096 square with few data", 0x10, 0x00);
  corpus.push_back({"only the start.jpg", {0xff, 0xd8, 0xff}});
  corpus.push_back({"start and end.jpg", {0xff, 0xd8, 0xff, 0xd9}});
  corpus.push_back({"printing inks.jpg", encode_jpeg(small_picture(4), 90, false, true)});
  corpus.push_back({"header twice.jpg", File(good.begin(), frame) + good});
}

void add_tga(Corpus& corpus) {
  const File raw = encode_tga(small_picture(4)), runs = encode_tga(small_picture(3), {true});
  const auto with = [&](const std::string& name, const File& from,
                        const std::vector<std::pair<std::size_t, int>>& changes) {
    File file = from;
    for (const auto& [at, value] : changes) file[at] = std::uint8_t(value);
    corpus.push_back({name + ".tga", file});
  };
  for (const int type : {0, 1, 4, 9, 12, 32, 255}) with(fmt::format("type {}", type), raw, {{2, type}});
  for (const int bits : {0, 1, 15, 16, 64, 255}) with(fmt::format("{} bits", bits), raw, {{16, bits}});
  with("grey of 24 bits", encode_tga(small_picture(3)), {{2, 3}});
  with("3 bits of alpha", raw, {{17, 3}});
  with("interleaved", raw, {{17, 0x48}});
  with("zero width", raw, {{12, 0}});
  with("zero height", raw, {{14, 0}});
  with("65535 square", raw, {{12, 255}, {13, 255}, {14, 255}, {15, 255}});
  with("16384 square", runs, {{13, 0x40}, {15, 0x40}, {12, 0}, {14, 0}});
  with("8192 square, raw", raw, {{13, 0x20}, {15, 0x20}, {12, 0}, {14, 0}});
  with("8192 square, runs", runs, {{13, 0x20}, {15, 0x20}, {12, 0}, {14, 0}});
  with("one row more, raw", raw, {{14, 18}});
  with("one row more, runs", runs, {{14, 18}});
  with("one row less, runs", encode_tga(small_picture(1), {true}), {{14, 16}, {18, 0xff}});
  with("id beyond the end", encode_tga(Image8(1, 1, 1)), {{0, 255}});
  with("colour map beyond the end", raw, {{1, 1}, {5, 255}, {6, 255}, {7, 32}});
  File overrun = encode_tga(Image8(10, 10, 3), {true});
  overrun[18] = 0xff;  // 128 pixels where 100 are left
  corpus.push_back({"run beyond the last pixel.tga", overrun});
  overrun[18] = 0x7f;
  corpus.push_back({"packet beyond the last pixel.tga", overrun + File(600)});
  for (const std::size_t size : {std::size_t{1}, std::size_t{17}, std::size_t{18}})
    corpus.push_back({fmt::format("{} zeros.tga", size), File(size)});
}

Corpus make_corpus() {
  Corpus corpus{{"empty.png", {}},
                {"one byte.png", {0x89}},
                {"one byte.tga", {0}},
                {"text.png", {'n', 'o', 't', ' ', 'a', 'n', ' ', 'i', 'm', 'a', 'g', 'e', '\n'}}};
  add_png(corpus);
  add_jpeg(corpus);
  add_tga(corpus);
  add_exr(corpus);
  ExrLayout tiled;
  tiled.tiled = true;
  tiled.half = true;
  add_damaged(corpus, "grey.png", encode_png(small_picture(1)));
  add_damaged(corpus, "rgba.png", encode_png(small_picture(4)));
  add_damaged(corpus, "baseline.jpg", encode_jpeg(small_picture(3)));
  add_damaged(corpus, "progressive.jpg", encode_jpeg(small_picture(1), 90, true));
  add_damaged(corpus, "raw.tga", encode_tga(small_picture(4)));
  add_damaged(corpus, "runs.tga", encode_tga(small_picture(3), {true}));
  add_damaged(corpus, "rows.exr", encode_exr(small_floats(3)));
  add_damaged(corpus, "tiles.exr", encode_exr(small_floats(4), tiled));
  return corpus;
}

}  // namespace intaglio::surface::corpus
