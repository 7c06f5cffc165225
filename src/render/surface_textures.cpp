#include "render/surface_textures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <fmt/format.h>

namespace intaglio::render {

namespace {

constexpr float padding_height = -1e9f;  // such a block is always skipped

HeightPyramid::Level cell_tops(const std::vector<float>& z, int width, int height, int block) {
  const auto padded = [block](int cells) { return (cells + block - 1) / block * block; };
  HeightPyramid::Level level{padded(width - 1), padded(height - 1), {}};
  level.highest.assign(std::size_t(level.width) * std::size_t(level.height), padding_height);
  for (int j = 0; j + 1 < height; ++j) {
    for (int i = 0; i + 1 < width; ++i) {
      const float* low = &z[std::size_t(j) * std::size_t(width) + std::size_t(i)];
      const float* high = low + width;
      level.highest[std::size_t(j) * std::size_t(level.width) + std::size_t(i)] =
          std::max(std::max(low[0], low[1]), std::max(high[0], high[1]));
    }
  }
  return level;
}

}  // namespace

HeightPyramid::Level halved_bounds(const HeightPyramid::Level& fine) {
  HeightPyramid::Level coarse{fine.width / 2, fine.height / 2, {}};
  coarse.highest.reserve(std::size_t(coarse.width) * std::size_t(coarse.height));
  for (int j = 0; j < coarse.height; ++j) {
    for (int i = 0; i < coarse.width; ++i) {
      const float* low = &fine.highest[std::size_t(2 * j) * std::size_t(fine.width) + std::size_t(2 * i)];
      const float* high = low + fine.width;
      coarse.highest.push_back(std::max(std::max(low[0], low[1]), std::max(high[0], high[1])));
    }
  }
  return coarse;
}

HeightPyramid make_height_pyramid(const std::vector<float>& heights, int width, int height) {
  int count = 1;
  while (count < HeightPyramid::most_levels && (1 << count) < std::max(width, height)) ++count;
  HeightPyramid pyramid;
  pyramid.levels.push_back(cell_tops(heights, width, height, 1 << (count - 1)));
  while (static_cast<int>(pyramid.levels.size()) < count)
    pyramid.levels.push_back(halved_bounds(pyramid.levels.back()));
  return pyramid;
}

namespace {

using Level = HeightLevels::Level;

// Room for the vertices 0, 2^k, ... that the cells of all levels up to the coarsest end at.
int padded(int vertices) {
  constexpr int block = 1 << HeightLevels::coarsest;
  return ((vertices - 1 + block - 1) / block + 1) * block;
}

Level finest(const surface::Surface& surface) {
  const double scale = surface.is_flat() ? 0 : 65535 / surface.max_depth();
  Level out{padded(surface.width() + 2), padded(surface.height() + 2), {}};
  out.z.reserve(std::size_t(out.width) * std::size_t(out.height));
  for (int j = 0; j < out.height; ++j)
    for (int i = 0; i < out.width; ++i)
      out.z.push_back(float(std::clamp(std::round(scale * surface.texel_z(i - 1, j - 1)), -65535.0, 0.0)));
  return out;
}

Level halved(const Level& fine) {
  Level out{std::max(fine.width / 2, 1), std::max(fine.height / 2, 1), {}};
  out.z.reserve(std::size_t(out.width) * std::size_t(out.height));
  const auto row_mean = [&](int i, int j) {
    j = std::clamp(j, 0, fine.height - 1);
    return 0.25f * (fine.at(std::max(i - 1, 0), j) + fine.at(std::min(i + 1, fine.width - 1), j)) +
           0.5f * fine.at(i, j);
  };
  for (int j = 0; j < out.height; ++j)
    for (int i = 0; i < out.width; ++i)
      out.z.push_back(std::round(0.25f * (row_mean(2 * i, 2 * j - 1) + row_mean(2 * i, 2 * j + 1)) +
                                 0.5f * row_mean(2 * i, 2 * j)));
  return out;
}

// Raises blocks to the cells of the field that has one cell a block.
void raise(HeightPyramid::Level& bounds, const Level& field) {
  for (int j = 0; j < bounds.height; ++j) {
    for (int i = 0; i < bounds.width; ++i) {
      float& top = bounds.highest[std::size_t(j) * std::size_t(bounds.width) + std::size_t(i)];
      if (top < -65535) continue;  // padding
      const int right = std::min(i + 1, field.width - 1), above = std::min(j + 1, field.height - 1);
      top = std::max({top, field.at(i, j), field.at(right, j), field.at(i, above), field.at(right, above)});
    }
  }
}

}  // namespace

HeightLevels make_height_levels(const surface::Surface& surface) {
  constexpr int few = 4;
  HeightLevels out;
  out.levels.push_back(finest(surface));
  while (std::max(out.levels.back().width, out.levels.back().height) > few)
    out.levels.push_back(halved(out.levels.back()));
  return out;
}

HeightPyramid bounds_of(const HeightLevels& heights, int width, int height) {
  const Level& finest = heights.levels.front();
  std::vector<float> z;
  z.reserve(std::size_t(width) * std::size_t(height));
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) z.push_back(finest.at(i, j));
  HeightPyramid pyramid = make_height_pyramid(z, width, height);
  for (std::size_t k = 1; k < pyramid.levels.size(); ++k) {
    pyramid.levels[k] = halved_bounds(pyramid.levels[k - 1]);
    if (k < heights.levels.size() && k <= HeightLevels::coarsest) raise(pyramid.levels[k], heights.levels[k]);
  }
  return pyramid;
}

namespace {

// Linear light, three floats a texel.
struct Plane {
  int width, height;
  std::vector<float> rgb;

  std::size_t at(int i, int j) const { return 3 * (std::size_t(j) * std::size_t(width) + std::size_t(i)); }
};

Plane linear(const Image8& image) {
  std::array<float, 256> table;
  for (int k = 0; k < 256; ++k) {
    const double s = k / 255.0;
    table[std::size_t(k)] = float(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
  }
  Plane out{image.width, image.height, std::vector<float>(image.data.size())};
  std::transform(image.data.begin(), image.data.end(), out.rgb.begin(),
                 [&](std::uint8_t k) { return table[k]; });
  return out;
}

// The texels that one of `half` texels covers of `whole`, with their shares.
struct Cover {
  int first = 0, count = 0;
  std::array<float, 3> share = {};
};
Cover cover(int k, int half, int whole) {
  const double from = double(k) * whole / half, to = double(k + 1) * whole / half;
  Cover out;
  out.first = int(from);
  for (int i = out.first; i < to && out.count < 3; ++i)
    out.share[std::size_t(out.count++)] =
        float((std::min(to, i + 1.0) - std::max(from, double(i))) / (to - from));
  return out;
}

Plane halved(const Plane& fine) {
  Plane out{std::max(fine.width / 2, 1), std::max(fine.height / 2, 1), {}};
  out.rgb.assign(3 * std::size_t(out.width) * std::size_t(out.height), 0.0f);
  for (int j = 0; j < out.height; ++j) {
    const Cover rows = cover(j, out.height, fine.height);
    for (int i = 0; i < out.width; ++i) {
      const Cover columns = cover(i, out.width, fine.width);
      for (int y = 0; y < rows.count; ++y)
        for (int x = 0; x < columns.count; ++x)
          for (std::size_t c = 0; c < 3; ++c)
            out.rgb[out.at(i, j) + c] += rows.share[std::size_t(y)] * columns.share[std::size_t(x)] *
                                         fine.rgb[fine.at(columns.first + x, rows.first + y) + c];
    }
  }
  return out;
}

// m / 512 * 2^(e - 15), the exponent being the brightest component's.
std::uint32_t packed(const float* rgb) {
  const float most = std::max({rgb[0], rgb[1], rgb[2]});
  int e = 0;  // most = 0.5..1 * 2^e
  std::frexp(most, &e);
  e = std::clamp(e, -15, 15);
  if (std::lround(std::ldexp(most, 9 - e)) > 511) ++e;
  const auto mantissa = [&](float x) { return std::uint32_t(std::lround(std::ldexp(x, 9 - e))); };
  return mantissa(rgb[0]) | mantissa(rgb[1]) << 9 | mantissa(rgb[2]) << 18 | std::uint32_t(e + 15) << 27;
}

ColourLevel packed(const Plane& plane) {
  ColourLevel out{plane.width, plane.height, {}};
  out.texels.reserve(plane.rgb.size() / 3);
  for (std::size_t k = 0; k < plane.rgb.size(); k += 3) out.texels.push_back(packed(&plane.rgb[k]));
  return out;
}

}  // namespace

std::vector<ColourLevel> colour_levels(const Image8& srgb) {
  std::vector<ColourLevel> out;
  Plane plane = linear(srgb);
  out.push_back(packed(plane));
  while (plane.width > 1 || plane.height > 1) {
    plane = halved(plane);
    out.push_back(packed(plane));
  }
  return out;
}

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
