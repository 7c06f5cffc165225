#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "tests/surface/image_corpus.h"

namespace intaglio::surface::corpus {

using namespace encoders;

namespace {

// The place of an attribute's value in an EXR; its size is the four bytes before.
std::size_t value_of(const File& file, const std::string& name, const std::string& type) {
  const std::string key = name + '\0' + type + '\0';
  const auto found = std::search(file.begin(), file.end(), key.begin(), key.end());
  REQUIRE(found != file.end());
  return std::size_t(found - file.begin()) + key.size() + 4;
}

void put(File& file, std::size_t at, std::int64_t value) {
  for (std::size_t k = 0; k < 4; ++k) file[at + k] = std::uint8_t(value >> (8 * k));
}

void add_exr_windows(Corpus& corpus, const File& good) {
  const std::size_t at = value_of(good, "dataWindow", "box2i");
  constexpr std::int64_t least = std::numeric_limits<std::int32_t>::min(),
                         most = std::numeric_limits<std::int32_t>::max();
  const auto window = [&](const std::string& name, const std::array<std::int64_t, 4>& box) {
    File file = good;
    for (std::size_t k = 0; k < 4; ++k) put(file, at + 4 * k, box[k]);
    corpus.push_back({name + ".exr", file});
  };
  window("empty window", {0, 0, -1, -1});
  window("backward window", {100, 100, 0, 0});
  window("window of everything", {least, least, most, most});
  window("window at the far end", {most - 23, most - 16, most, most});
  window("window at the near end", {least, least, least + 23, least + 16});
  window("one column too many", {0, 0, 16384, 16});
  window("more than 64 Mpx", {0, 0, 16383, 16383});
  window("large and empty", {0, 0, 8191, 8191});
  window("moved window", {5, 5, 28, 21});
}

void add_exr_attributes(Corpus& corpus, const File& good, const File& tiled) {
  const auto with = [&](const std::string& name, const File& from, std::size_t at, std::int64_t value) {
    corpus.push_back({name + ".exr", from});
    put(corpus.back().bytes, at, value);
  };
  const std::size_t window = value_of(good, "dataWindow", "box2i"),
                    channels = value_of(good, "channels", "chlist");
  for (const std::int64_t version : {0, 1, 3, 0x802, 0x1002, 0x10002})
    with(fmt::format("version {:#x}", version), good, 4, version);
  with("tiled without tiles", good, 4, 0x202);
  with("no window", good, window - 10 - 7, 0x41414141);
  with("window of another type", good, window - 10, 0x41414141);
  with("window of 15 bytes", good, window - 4, 15);
  with("attribute of 2 GB", good, window - 4, 0x7fffffff);
  with("attribute of -1 bytes", good, window - 4, -1);
  with("whole numbers", good, channels + 2, 0);
  with("samples of type 7", good, channels + 2, 7);
  with("subsampled", good, channels + 10, 2);
  with("subsampled by 0", good, channels + 10, 0);
  with("no channels", good, channels, 0);
  File file = good;
  file[value_of(good, "compression", "compression")] = 10;
  corpus.push_back({"unknown compression.exr", file});
  const std::size_t tiles = value_of(tiled, "tiles", "tiledesc");
  for (const std::int64_t side :
       {std::int64_t{0}, std::int64_t{4097}, std::int64_t{0x7fffffff}, std::int64_t{-1}})
    with(fmt::format("tiles of {}", side), tiled, tiles, side);
  file = tiled;
  file[tiles + 8] = 0x77;
  corpus.push_back({"tiles of an unknown mode.exr", file});
  const File twice(good.begin() + std::ptrdiff_t(window) - 21, good.begin() + std::ptrdiff_t(window) + 16);
  file = good;
  file.insert(file.begin() + std::ptrdiff_t(window) - 21, twice.begin(), twice.end());
  corpus.push_back({"window twice.exr", file});
}

}  // namespace

void add_exr(Corpus& corpus) {
  ExrLayout layout;
  layout.tiled = true;
  layout.compression = Imf::PIZ_COMPRESSION;
  const File good = encode_exr(small_floats(1)), tiled = encode_exr(small_floats(4), layout);
  add_exr_windows(corpus, good);
  add_exr_attributes(corpus, good, tiled);
  File file = good;
  const std::size_t table = value_of(good, "screenWindowWidth", "float") + 4 + 1;
  put(file, table + 4, 0x7fffffff);
  corpus.push_back({"offset beyond the end.exr", file});
  file = good;
  put(file, table + 16, 1 << 20);  // the first block's row, after a table of 2 entries
  corpus.push_back({"block of another row.exr", file});
  file = good;
  put(file, table + 20, 0x7fffffff);
  corpus.push_back({"block of 2 GB.exr", file});
  Image<float> floats = small_floats(3);
  floats.data[50] = std::numeric_limits<float>::infinity();
  corpus.push_back({"infinite.exr", encode_exr(floats)});
  corpus.push_back({"only the signature.exr", {0x76, 0x2f, 0x31, 0x01}});
}

}  // namespace intaglio::surface::corpus
