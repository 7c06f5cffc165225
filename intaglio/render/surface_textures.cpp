#include "intaglio/render/surface_textures.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "intaglio/render/height_pyramid.h"

namespace intaglio::render {

namespace {

// Fractions of the greatest depth, in 65535ths, negative: the larger, the higher.
std::vector<float> bordered_heights(const surface::Surface& surface) {
  const double scale = surface.is_flat() ? 0 : 65535 / surface.max_depth();
  std::vector<float> z;
  z.reserve(std::size_t(surface.width() + 2) * std::size_t(surface.height() + 2));
  for (int j = -1; j <= surface.height(); ++j)
    for (int i = -1; i <= surface.width(); ++i)
      z.push_back(float(std::clamp(std::round(scale * surface.texel_z(i, j)), -65535.0, 0.0)));
  return z;
}

std::vector<std::uint16_t> as_depth(const std::vector<float>& z) {
  std::vector<std::uint16_t> out(z.size());
  std::transform(z.begin(), z.end(), out.begin(),
                 [](float a) { return std::uint16_t(std::min(-a, 65535.0f)); });
  return out;
}

// Ten bits a component, 511 n + 512, so that the plane's normal is exact.
std::vector<std::uint32_t> packed_normals(const surface::Surface& surface) {
  const std::vector<float> normal = surface.normal_texture();
  std::vector<std::uint32_t> out(normal.size() / 3);
  const auto ten_bits = [](float a) { return std::uint32_t(std::lround(511 * a) + 512); };
  for (std::size_t k = 0; k < out.size(); ++k)
    out[k] = ten_bits(normal[3 * k]) | ten_bits(normal[3 * k + 1]) << 10 | ten_bits(normal[3 * k + 2]) << 20;
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
  constexpr gl::TextureFormat fraction = {GL_R16, GL_RED, GL_UNSIGNED_SHORT};
  constexpr gl::TextureFormat ten_bits = {GL_RGB10_A2, GL_RGBA, GL_UNSIGNED_INT_2_10_10_10_REV};
  SurfaceTextures result;
  const int width = surface.width() + 2;
  const int height = surface.height() + 2;
  const std::vector<float> z = bordered_heights(surface);
  result.heights = mipmapped(width, height, fraction, as_depth(z).data(), surface::Edge::clamp);
  // A picture asks for one or two levels only, the same everywhere: nothing to blend between.
  result.heights.set_filter(GL_LINEAR_MIPMAP_NEAREST, GL_LINEAR);
  // Level 0 is left out: to ask a cell's patch costs no more than to ask whether it need be asked.
  const HeightPyramid pyramid = make_height_pyramid(z, width, height);
  const auto& blocks = pyramid.levels[1];
  result.bounds = gl::Texture(blocks.width, blocks.height, fraction, nullptr);
  result.bounds.set_filter(GL_NEAREST_MIPMAP_NEAREST, GL_NEAREST);
  for (auto level = pyramid.levels.begin() + 1; level != pyramid.levels.end(); ++level) {
    result.bounds.set_level(result.pyramid_levels++, level->width, level->height, fraction,
                            as_depth(level->highest).data());
    result.bytes += 2 * level->highest.size();
  }
  result.normals =
      mipmapped(surface.width(), surface.height(), ten_bits, packed_normals(surface).data(), surface.edge());
  result.colour = colour_texture(surface);
  // A texture with its mips is 4/3 of itself; drivers keep four bytes for a colour.
  const std::size_t texels = std::size_t(surface.width()) * std::size_t(surface.height());
  const std::size_t coloured = surface.colour().data.size() / 3;
  result.bytes += (2 * z.size() + 4 * texels + 4 * coloured) * 4 / 3;
  return result;
}

}  // namespace intaglio::render
