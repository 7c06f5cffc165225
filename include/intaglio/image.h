// A plain image in memory: interleaved channels, row 0 at the top.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace intaglio {

template <class T>
struct Image {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<T> data;  // height x width x channels

  Image() = default;
  Image(int w, int h, int c)
      : width(w), height(h), channels(c), data(std::size_t(w) * std::size_t(h) * std::size_t(c)) {}

  T& at(int x, int y, int c) { return data[index(x, y, c)]; }
  const T& at(int x, int y, int c) const { return data[index(x, y, c)]; }
  bool empty() const { return data.empty(); }

 private:
  std::size_t index(int x, int y, int c) const {
    assert(x >= 0 && x < width && y >= 0 && y < height && c >= 0 && c < channels);
    return (std::size_t(y) * std::size_t(width) + std::size_t(x)) * std::size_t(channels) + std::size_t(c);
  }
};

using Image8 = Image<std::uint8_t>;
using Image16 = Image<std::uint16_t>;

// PNG bytes of an image with 1, 3 or 4 channels.
std::vector<std::uint8_t> encode_png(const Image8& image);
std::vector<std::uint8_t> encode_png(const Image16& image);

}  // namespace intaglio
