// A Surface on the device: what shaders/heights.glsl, march_pyramid.glsl and surface_shading.glsl read. Made
// once; needs a current GL context. Device memory: 3 + 0.7 + 5.3 bytes a texel, and 4 a texel of the colour
// map.
#pragma once

#include "intaglio/core/error.h"
#include "intaglio/render/gl.h"
#include "intaglio/surface/surface.h"

namespace intaglio::render {

struct SurfaceTextures {
  gl::Texture heights;  // depth fractions of 16 bits, as height_levels.h has them
  gl::Texture bounds;   // their least in blocks of 2 x 2 cells and larger
  gl::Texture normals;  // 10 bits a component, mipmapped
  gl::Texture colour;   // as colour_levels.h has them; one texel when the surface has none
  int pyramid_levels = 0;
  std::size_t bytes = 0;  // of them all

  static Result<SurfaceTextures> create(const surface::Surface& surface);
};

}  // namespace intaglio::render
