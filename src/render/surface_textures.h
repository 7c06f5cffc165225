// The highest z of square blocks of a height field's cells, at every power of two: what lets a ray skip what
// it passes over. Pure; CPU only. Cost: 4/3 passes over the texels, once a surface. Read by
// shaders/march_pyramid.glsl.
#pragma once

#include <cstdint>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/image.h"
#include "render/gl.h"
#include "surface/surface.h"

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

// The heights of a surface as the device keeps them: the vertices of its bilinear field, and coarser fields
// of the same kind for samples that are larger than texels.
//
// A field of level k + 1 has every second vertex of level k, each with the mean (1 2 1) / 4 over it and its
// neighbours along u and along v. So its cells are exactly the blocks of 2 x 2 cells that HeightPyramid
// bounds, and a ray that is traced no further than blocks of 2^k cells meets the field of level k there.
// Detail finer than a sample is gone from it, detail of two samples and more stays.
//
// Pure; CPU only. Cost: 2 passes over the texels, once a surface. Read by shaders/heights.glsl.

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

// A colour map as the device keeps it: linear light with a shared exponent (9 bits a component, finer than
// sRGB's steps), and levels of half the size that are its means. Filtering is then filtering of light, as
// with an sRGB texture, but sRGB's curve is not paid anew by each of a sample's eight texels (llvmpipe: a
// quarter of all light). Pure; CPU only. Cost: about 10 ns a texel and level.

struct ColourLevel {
  int width = 0, height = 0;
  std::vector<std::uint32_t> texels;  // GL_UNSIGNED_INT_5_9_9_9_REV: red lowest
};

// From the image itself (sRGB, 3 channels, not empty) down to a single texel; each level has half the one
// before, rounded down, as OpenGL wants it.
std::vector<ColourLevel> colour_levels(const Image8& srgb);

// A Surface on the device: what shaders/heights.glsl, march_pyramid.glsl and surface_shading.glsl read. Made
// once; needs a current GL context. Device memory: 3 + 0.7 + 5.3 bytes a texel, and 4 a texel of the colour
// map.

struct SurfaceTextures {
  gl::Texture heights;  // depth fractions of 16 bits, as surface_textures.h has them
  gl::Texture bounds;   // their least in blocks of 2 x 2 cells and larger
  gl::Texture normals;  // 10 bits a component, mipmapped
  gl::Texture colour;   // as surface_textures.h has them; one texel when the surface has none
  int pyramid_levels = 0;
  std::size_t bytes = 0;  // of them all

  static Result<SurfaceTextures> create(const surface::Surface& surface);
};

}  // namespace intaglio::render
