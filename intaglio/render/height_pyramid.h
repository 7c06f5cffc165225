// The highest z of square blocks of a height field's cells, at every power of two: what lets a ray skip what
// it passes over. Pure; CPU only. Cost: 4/3 passes over the texels, once a surface. Read by
// shaders/march_pyramid.glsl.
#pragma once

#include <vector>

namespace intaglio::render {

struct HeightPyramid {
  static constexpr int most_levels = 7;  // blocks of 64 cells are as large as helps

  struct Level {
    int width, height;
    std::vector<float> highest;  // row by row, metres
  };
  // Level 0 has one value a cell, the highest of its four corners; each level halves the sides. The sides of
  // level 0 are padded to a multiple of the top level's block, so that halving is exact; the padding is far
  // below everything.
  std::vector<Level> levels;
};

// The next level: the greatest of each 2 x 2.
HeightPyramid::Level halved_bounds(const HeightPyramid::Level& fine);

// `heights` is width x height texels, row by row, at least 2 x 2; cell (i, j) has texels (i, j) and (i + 1, j
// + 1).
HeightPyramid make_height_pyramid(const std::vector<float>& heights, int width, int height);

}  // namespace intaglio::render
