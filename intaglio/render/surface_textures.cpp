#include "intaglio/render/surface_textures.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "intaglio/render/colour_levels.h"
#include "intaglio/render/height_levels.h"

namespace intaglio::render {

namespace {

constexpr gl::TextureFormat ten_bits = {GL_RGB10_A2, GL_RGBA, GL_UNSIGNED_INT_2_10_10_10_REV};

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
  const auto component = [](float a) { return std::uint32_t(std::lround(511 * a) + 512); };
  for (std::size_t k = 0; k < out.size(); ++k)
    out[k] =
        component(normal[3 * k]) | component(normal[3 * k + 1]) << 10 | component(normal[3 * k + 2]) << 20;
  return out;
}

void filter_all_levels(gl::Texture& texture, surface::Edge edge) {
  texture.set_filter(GL_LINEAR_MIPMAP_LINEAR, GL_LINEAR);
  texture.set_edge(edge == surface::Edge::wrap ? GL_REPEAT : GL_CLAMP_TO_EDGE);
}

gl::Texture mipmapped(int width, int height, const gl::TextureFormat& format, const void* data,
                      surface::Edge edge) {
  gl::Texture texture(width, height, format, data);
  texture.make_mipmaps();
  filter_all_levels(texture, edge);
  return texture;
}

gl::Texture colour_texture(const surface::Surface& surface) {
  const Image8& image = surface.colour();
  constexpr gl::TextureFormat light = {GL_RGB9_E5, GL_RGB, GL_UNSIGNED_INT_5_9_9_9_REV};
  constexpr std::uint32_t nobody_looks[] = {0};
  if (image.empty()) return gl::Texture(1, 1, light, nobody_looks);
  gl::Texture texture(image.width, image.height, light, nullptr);
  int at = 0;
  for (const ColourLevel& level : colour_levels(image))
    texture.set_level(at++, level.width, level.height, light, level.texels.data());
  filter_all_levels(texture, surface.edge());
  return texture;
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
  SurfaceTextures result;
  const HeightLevels heights = make_height_levels(surface);
  result.heights = gl::Texture(heights.levels[0].width, heights.levels[0].height, fraction, nullptr);
  // A picture asks for one level at a time: nothing to blend between.
  result.heights.set_filter(GL_LINEAR_MIPMAP_NEAREST, GL_LINEAR);
  int at = 0;
  for (const HeightLevels::Level& level : heights.levels) {
    result.heights.set_level(at++, level.width, level.height, fraction, as_depth(level.z).data());
    result.bytes += 2 * level.z.size();
  }
  // Level 0 is left out: to ask a cell's patch costs no more than to ask whether it need be asked.
  const HeightPyramid pyramid = bounds_of(heights, surface.width() + 2, surface.height() + 2);
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
  result.bytes += (4 * texels + 4 * coloured) * 4 / 3;
  return result;
}

}  // namespace intaglio::render
