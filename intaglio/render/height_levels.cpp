#include "intaglio/render/height_levels.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace intaglio::render {

namespace {

using Level = HeightLevels::Level;

// Room for the vertices 0, 2^k, ... that the cells of all levels up to the coarsest end at.
int padded(int vertices) {
  constexpr int block = 1 << HeightLevels::coarsest;
  return ((vertices - 1 + block - 1) / block + 1) * block;
}

Level finest(const surface::Surface& surface) {
  const double scale = surface.is_flat() ? 0 : 65535 / surface.max_depth();
  Level out{padded(surface.width() + 2), padded(surface.height() + 2), {}};
  out.z.reserve(std::size_t(out.width) * std::size_t(out.height));
  for (int j = 0; j < out.height; ++j)
    for (int i = 0; i < out.width; ++i)
      out.z.push_back(float(std::clamp(std::round(scale * surface.texel_z(i - 1, j - 1)), -65535.0, 0.0)));
  return out;
}

Level halved(const Level& fine) {
  Level out{std::max(fine.width / 2, 1), std::max(fine.height / 2, 1), {}};
  out.z.reserve(std::size_t(out.width) * std::size_t(out.height));
  const auto row_mean = [&](int i, int j) {
    j = std::clamp(j, 0, fine.height - 1);
    return 0.25f * (fine.at(std::max(i - 1, 0), j) + fine.at(std::min(i + 1, fine.width - 1), j)) +
           0.5f * fine.at(i, j);
  };
  for (int j = 0; j < out.height; ++j)
    for (int i = 0; i < out.width; ++i)
      out.z.push_back(std::round(0.25f * (row_mean(2 * i, 2 * j - 1) + row_mean(2 * i, 2 * j + 1)) +
                                 0.5f * row_mean(2 * i, 2 * j)));
  return out;
}

// Raises blocks to the cells of the field that has one cell a block.
void raise(HeightPyramid::Level& bounds, const Level& field) {
  for (int j = 0; j < bounds.height; ++j) {
    for (int i = 0; i < bounds.width; ++i) {
      float& top = bounds.highest[std::size_t(j) * std::size_t(bounds.width) + std::size_t(i)];
      if (top < -65535) continue;  // padding
      const int right = std::min(i + 1, field.width - 1), above = std::min(j + 1, field.height - 1);
      top = std::max({top, field.at(i, j), field.at(right, j), field.at(i, above), field.at(right, above)});
    }
  }
}

}  // namespace

HeightLevels make_height_levels(const surface::Surface& surface) {
  constexpr int few = 4;
  HeightLevels out;
  out.levels.push_back(finest(surface));
  while (std::max(out.levels.back().width, out.levels.back().height) > few)
    out.levels.push_back(halved(out.levels.back()));
  return out;
}

HeightPyramid bounds_of(const HeightLevels& heights, int width, int height) {
  const Level& finest = heights.levels.front();
  std::vector<float> z;
  z.reserve(std::size_t(width) * std::size_t(height));
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) z.push_back(finest.at(i, j));
  HeightPyramid pyramid = make_height_pyramid(z, width, height);
  for (std::size_t k = 1; k < pyramid.levels.size(); ++k) {
    pyramid.levels[k] = halved_bounds(pyramid.levels[k - 1]);
    if (k < heights.levels.size() && k <= HeightLevels::coarsest) raise(pyramid.levels[k], heights.levels[k]);
  }
  return pyramid;
}

}  // namespace intaglio::render
