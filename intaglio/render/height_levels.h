// The heights of a surface as the device keeps them: the vertices of its bilinear field, and coarser fields
// of the same kind for samples that are larger than texels.
//
// A field of level k + 1 has every second vertex of level k, each with the mean (1 2 1) / 4 over it and its
// neighbours along u and along v. So its cells are exactly the blocks of 2 x 2 cells that HeightPyramid
// bounds, and a ray that is traced no further than blocks of 2^k cells meets the field of level k there.
// Detail finer than a sample is gone from it, detail of two samples and more stays.
//
// Pure; CPU only. Cost: 2 passes over the texels, once a surface. Read by shaders/heights.glsl.
#pragma once

#include <vector>

#include "intaglio/render/height_pyramid.h"
#include "intaglio/surface/surface.h"

namespace intaglio::render {

struct HeightLevels {
  static constexpr int coarsest = 4;  // of the fields that can be traced

  struct Level {
    int width, height;
    std::vector<float> z;  // row by row
    float at(int i, int j) const { return z[std::size_t(j) * std::size_t(width) + std::size_t(i)]; }
  };
  // Sizes halve as a texture's do, down to a few vertices; those of level 0 are padded so that up to
  // `coarsest` nothing is lost by it.
  std::vector<Level> levels;
};

// In 65535ths of the greatest depth, negative: the larger, the higher; whole numbers. Vertex (0, 0) of level
// 0 is texel (-1, -1): a border of one texel holds the edge rule.
HeightLevels make_height_levels(const surface::Surface& surface);

// The pyramid over level 0's cells (`width` x `height` vertices count), whose blocks bound the coarser
// fields, too.
HeightPyramid bounds_of(const HeightLevels& heights, int width, int height);

}  // namespace intaglio::render
