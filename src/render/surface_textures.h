// GPU textures of a Surface: heights with coarser levels, a pyramid of height bounds, normals and colour, as
// shaders/heights.glsl, march_pyramid.glsl and surface_shading.glsl read them. Everything but
// SurfaceTextures::create is pure and needs no OpenGL.
#pragma once

#include <cstdint>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/image.h"
#include "render/gl.h"
#include "surface/surface.h"

namespace intaglio::render {

// Heights, or bounds of heights, row by row.
struct HeightGrid {
  int width = 0, height = 0;
  std::vector<float> z;

  std::size_t index(int i, int j) const { return std::size_t(j) * std::size_t(width) + std::size_t(i); }
  float& at(int i, int j) { return z[index(i, j)]; }
  float at(int i, int j) const { return z[index(i, j)]; }
};

// The maximum height of square blocks of a height field's cells, at every power of two; lets a ray skip
// blocks that it passes above. Costs 4/3 passes over the texels, once a surface. Read by
// shaders/march_pyramid.glsl.
struct HeightPyramid {
  static constexpr int max_levels = 7;  // blocks larger than 64 cells do not speed up traversal

  // Level 0 has one value a cell, the maximum of its four corners; each level halves the sides. The sides of
  // level 0 are padded to a multiple of the top level's block, so that halving is exact; the padding is far
  // below everything.
  std::vector<HeightGrid> levels;
};

// The next level: the maximum of each 2 x 2.
HeightGrid coarser_bounds(const HeightGrid& fine);

// `heights` has at least 2 x 2 texels; cell (i, j) has texels (i, j) to (i + 1, j + 1) as its corners.
HeightPyramid make_height_pyramid(const HeightGrid& heights);

// The heights of a surface on the GPU: the vertices of its bilinear field, and coarser fields of the same
// kind for samples that are larger than texels.
//
// A field of level k + 1 has every second vertex of level k, each with the mean (1 2 1) / 4 over it and its
// neighbours along u and along v. So its cells are exactly the blocks of 2 x 2 cells that HeightPyramid
// bounds, and a traversal that stops at blocks of 2^k cells intersects the level-k field. Detail below the
// sample size is filtered out; detail of two samples or more is kept.
//
// Costs 2 passes over the texels, once a surface. Read by shaders/heights.glsl.
struct HeightLevels {
  static constexpr int coarsest_traced = 4;

  // Sizes halve as a texture's do, down to a few vertices; level 0 is padded so that halving is exact up to
  // coarsest_traced.
  std::vector<HeightGrid> levels;
};

// Heights are integers in -65535..0, in units of max_depth / 65535. Vertex (0, 0) of level 0 is texel (-1,
// -1): a one-texel border applies the wrap or clamp rule.
HeightLevels make_height_levels(const surface::Surface& surface);

// The pyramid over the cells of level 0 (`width` x `height` vertices count), whose blocks bound the coarser
// fields, too.
HeightPyramid height_bounds(const HeightLevels& heights, int width, int height);

// A colour map on the GPU: linear light in RGB9E5 (finer than sRGB's steps), each level the mean of the one
// before. An sRGB texture would filter light just as well, but llvmpipe decodes sRGB for each of the eight
// texels of a trilinear fetch, a quarter of the shading cost. Costs about 10 ns a texel and level.
struct ColourLevel {
  int width = 0, height = 0;
  std::vector<std::uint32_t> texels;  // GL_UNSIGNED_INT_5_9_9_9_REV: red lowest
};

// From the image itself (sRGB, 3 channels, not empty) down to a single texel; each level has half the size of
// the one before, rounded down, as OpenGL requires.
std::vector<ColourLevel> colour_levels(const Image8& srgb);

// The textures of one surface; needs a current GL context. GPU memory: 3 + 0.7 + 5.3 bytes a texel, and 5.3 a
// texel of the colour map.
struct SurfaceTextures {
  gl::Texture heights;  // 16-bit depth fractions, the levels of HeightLevels
  gl::Texture bounds;   // minimum depth in blocks of 2 x 2 cells and larger: HeightPyramid
  gl::Texture normals;  // 10 bits a component, mipmapped
  gl::Texture colour;   // ColourLevel; one texel when the surface has no colour map
  int pyramid_levels = 0;
  std::size_t bytes = 0;  // total

  static Result<SurfaceTextures> create(const surface::Surface& surface);

 private:
  void upload_heights(const surface::Surface& surface);
};

}  // namespace intaglio::render
