// A colour map as the device keeps it: linear light with a shared exponent (9 bits a component, finer than
// sRGB's steps), and levels of half the size that are its means. Filtering is then filtering of light, as
// with an sRGB texture, but sRGB's curve is not paid anew by each of a sample's eight texels (llvmpipe: a
// quarter of all light). Pure; CPU only. Cost: about 10 ns a texel and level.
#pragma once

#include <cstdint>
#include <vector>

#include "intaglio/core/image.h"

namespace intaglio::render {

struct ColourLevel {
  int width = 0, height = 0;
  std::vector<std::uint32_t> texels;  // GL_UNSIGNED_INT_5_9_9_9_REV: red lowest
};

// From the image itself (sRGB, 3 channels, not empty) down to a single texel; each level has half the one
// before, rounded down, as OpenGL wants it.
std::vector<ColourLevel> colour_levels(const Image8& srgb);

}  // namespace intaglio::render
