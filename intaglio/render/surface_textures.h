// A Surface on the device: what shaders/heights.glsl, march_pyramid.glsl and slab.frag read. Made once; needs
// a current GL context. Device memory: about 4 + 5.3 + 10.7 bytes a texel and the colour map.
#pragma once

#include "intaglio/core/error.h"
#include "intaglio/render/gl.h"
#include "intaglio/surface/surface.h"

namespace intaglio::render {

struct SurfaceTextures {
  gl::Texture heights;  // metres, with a border of one texel that holds the edge rule
  gl::Texture bounds;   // pyramid of the highest z of the cells
  gl::Texture relief;   // normal and depth fraction, mipmapped
  gl::Texture colour;   // sRGB, mipmapped; one white texel when the surface has none
  int pyramid_levels = 0;

  static Result<SurfaceTextures> create(const surface::Surface& surface);
};

}  // namespace intaglio::render
