#include "intaglio/render/height_pyramid.h"

#include <algorithm>
#include <cstddef>

namespace intaglio::render {

namespace {

constexpr float padding_height = -1e9f;  // such a block is always skipped

HeightPyramid::Level cell_tops(const std::vector<float>& z, int width, int height, int block) {
  const auto padded = [block](int cells) { return (cells + block - 1) / block * block; };
  HeightPyramid::Level level{padded(width - 1), padded(height - 1), {}};
  level.highest.assign(std::size_t(level.width) * std::size_t(level.height), padding_height);
  for (int j = 0; j + 1 < height; ++j) {
    for (int i = 0; i + 1 < width; ++i) {
      const float* low = &z[std::size_t(j) * std::size_t(width) + std::size_t(i)];
      const float* high = low + width;
      level.highest[std::size_t(j) * std::size_t(level.width) + std::size_t(i)] =
          std::max(std::max(low[0], low[1]), std::max(high[0], high[1]));
    }
  }
  return level;
}

}  // namespace

HeightPyramid::Level halved_bounds(const HeightPyramid::Level& fine) {
  HeightPyramid::Level coarse{fine.width / 2, fine.height / 2, {}};
  coarse.highest.reserve(std::size_t(coarse.width) * std::size_t(coarse.height));
  for (int j = 0; j < coarse.height; ++j) {
    for (int i = 0; i < coarse.width; ++i) {
      const float* low = &fine.highest[std::size_t(2 * j) * std::size_t(fine.width) + std::size_t(2 * i)];
      const float* high = low + fine.width;
      coarse.highest.push_back(std::max(std::max(low[0], low[1]), std::max(high[0], high[1])));
    }
  }
  return coarse;
}

HeightPyramid make_height_pyramid(const std::vector<float>& heights, int width, int height) {
  int count = 1;
  while (count < HeightPyramid::most_levels && (1 << count) < std::max(width, height)) ++count;
  HeightPyramid pyramid;
  pyramid.levels.push_back(cell_tops(heights, width, height, 1 << (count - 1)));
  while (static_cast<int>(pyramid.levels.size()) < count)
    pyramid.levels.push_back(halved_bounds(pyramid.levels.back()));
  return pyramid;
}

}  // namespace intaglio::render
