#include "intaglio/render/surface_textures.h"

#include <algorithm>

#include "intaglio/render/height_pyramid.h"

namespace intaglio::render {

namespace {

std::vector<float> bordered_heights(const surface::Surface& surface) {
  std::vector<float> z;
  z.reserve(std::size_t(surface.width() + 2) * std::size_t(surface.height() + 2));
  for (int j = -1; j <= surface.height(); ++j) {
    for (int i = -1; i <= surface.width(); ++i) z.push_back(static_cast<float>(surface.texel_z(i, j)));
  }
  return z;
}

// RGBA: the normal and the depth fraction.
std::vector<float> normals_and_depth(const surface::Surface& surface) {
  const std::vector<float> normal = surface.normal_texture();
  const std::vector<float> depth = surface.depth_texture();
  const std::size_t count = normal.size() / 3;
  std::vector<float> out(count * 4);
  for (std::size_t k = 0; k < count; ++k) {
    std::copy_n(&normal[3 * k], 3, &out[4 * k]);
    out[4 * k + 3] = depth.empty() ? 0.0f : depth[k];
  }
  return out;
}

gl::Texture mipmapped(int width, int height, const gl::TextureFormat& format, const void* data,
                      surface::Edge edge) {
  gl::Texture texture(width, height, format, data);
  texture.make_mipmaps();
  texture.set_filter(GL_LINEAR_MIPMAP_LINEAR, GL_LINEAR);
  texture.set_edge(edge == surface::Edge::wrap ? GL_REPEAT : GL_CLAMP_TO_EDGE);
  return texture;
}

gl::Texture colour_texture(const surface::Surface& surface) {
  const Image8& image = surface.colour();
  constexpr gl::TextureFormat rgb = {GL_SRGB8, GL_RGB, GL_UNSIGNED_BYTE};
  constexpr std::uint8_t white[] = {255, 255, 255};
  if (image.empty()) return gl::Texture(1, 1, rgb, white);
  return mipmapped(image.width, image.height, rgb, image.data.data(), surface.edge());
}

}  // namespace

Result<SurfaceTextures> SurfaceTextures::create(const surface::Surface& surface) {
  GLint limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  constexpr int border = 2 + (1 << HeightPyramid::most_levels);  // of the heights, and the pyramid's padding
  const int largest = std::max(
      {surface.width() + border, surface.height() + border, surface.colour().width, surface.colour().height});
  if (largest > limit) {
    return fail(
        "renderer",
        fmt::format("a texture of {} x {} texels is too large to draw", surface.width(), surface.height()),
        fmt::format("this driver draws textures up to {} texels wide and high", limit - border));
  }
  constexpr gl::TextureFormat metres = {GL_R32F, GL_RED, GL_FLOAT};
  SurfaceTextures result;
  const int width = surface.width() + 2;
  const int height = surface.height() + 2;
  const std::vector<float> z = bordered_heights(surface);
  result.heights = gl::Texture(width, height, metres, z.data());
  result.heights.set_filter(GL_LINEAR, GL_LINEAR);

  const HeightPyramid pyramid = make_height_pyramid(z, width, height);
  result.bounds = gl::Texture(pyramid.levels[0].width, pyramid.levels[0].height, metres, nullptr);
  result.bounds.set_filter(GL_NEAREST_MIPMAP_NEAREST, GL_NEAREST);
  for (const auto& level : pyramid.levels) {
    result.bounds.set_level(result.pyramid_levels++, level.width, level.height, metres, level.highest.data());
  }
  result.relief = mipmapped(surface.width(), surface.height(), {GL_RGBA16F, GL_RGBA, GL_FLOAT},
                            normals_and_depth(surface).data(), surface.edge());
  result.colour = colour_texture(surface);
  return result;
}

}  // namespace intaglio::render
