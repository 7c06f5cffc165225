#include "render/surface_textures.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace intaglio::render {

namespace {

constexpr float padding_height = -1e9f;  // such a block is always skipped

HeightGrid cell_tops(const HeightGrid& heights, int block) {
  const auto padded = [block](int cells) { return (cells + block - 1) / block * block; };
  HeightGrid level{padded(heights.width - 1), padded(heights.height - 1), {}};
  level.z.assign(std::size_t(level.width) * std::size_t(level.height), padding_height);
  for (int j = 0; j + 1 < heights.height; ++j) {
    for (int i = 0; i + 1 < heights.width; ++i) {
      const float* low = &heights.z[heights.index(i, j)];
      const float* high = low + heights.width;
      level.at(i, j) = std::max(std::max(low[0], low[1]), std::max(high[0], high[1]));
    }
  }
  return level;
}

}  // namespace

HeightGrid coarser_bounds(const HeightGrid& fine) {
  HeightGrid coarse{fine.width / 2, fine.height / 2, {}};
  coarse.z.reserve(std::size_t(coarse.width) * std::size_t(coarse.height));
  for (int j = 0; j < coarse.height; ++j) {
    for (int i = 0; i < coarse.width; ++i) {
      const float* low = &fine.z[fine.index(2 * i, 2 * j)];
      const float* high = low + fine.width;
      coarse.z.push_back(std::max(std::max(low[0], low[1]), std::max(high[0], high[1])));
    }
  }
  return coarse;
}

HeightPyramid make_height_pyramid(const HeightGrid& heights) {
  int count = 1;
  while (count < HeightPyramid::max_levels && (1 << count) < std::max(heights.width, heights.height)) ++count;
  HeightPyramid pyramid;
  pyramid.levels.push_back(cell_tops(heights, 1 << (count - 1)));
  while (int(pyramid.levels.size()) < count) pyramid.levels.push_back(coarser_bounds(pyramid.levels.back()));
  return pyramid;
}

namespace {

// `vertices` rounded up so that the cells of every traced level end on a stored vertex.
int padded(int vertices) {
  constexpr int block = 1 << HeightLevels::coarsest_traced;
  return ((vertices - 1 + block - 1) / block + 1) * block;
}

HeightGrid finest_level(const surface::Surface& surface) {
  const double scale = surface.is_flat() ? 0 : 65535 / surface.max_depth();
  HeightGrid out{padded(surface.width() + 2), padded(surface.height() + 2), {}};
  out.z.reserve(std::size_t(out.width) * std::size_t(out.height));
  for (int j = 0; j < out.height; ++j)
    for (int i = 0; i < out.width; ++i)
      out.z.push_back(float(std::clamp(std::round(scale * surface.texel_z(i - 1, j - 1)), -65535.0, 0.0)));
  return out;
}

HeightGrid half_resolution_heights(const HeightGrid& fine) {
  HeightGrid out{std::max(fine.width / 2, 1), std::max(fine.height / 2, 1), {}};
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

// Raises the bounds of blocks to the field that has one cell a block.
void include_coarser_field(HeightGrid& bounds, const HeightGrid& field) {
  for (int j = 0; j < bounds.height; ++j) {
    for (int i = 0; i < bounds.width; ++i) {
      float& top = bounds.at(i, j);
      if (top < -65535) continue;  // padding
      const int right = std::min(i + 1, field.width - 1), above = std::min(j + 1, field.height - 1);
      top = std::max({top, field.at(i, j), field.at(right, j), field.at(i, above), field.at(right, above)});
    }
  }
}

}  // namespace

HeightLevels make_height_levels(const surface::Surface& surface) {
  constexpr int smallest_side = 4;
  HeightLevels out;
  out.levels.push_back(finest_level(surface));
  while (std::max(out.levels.back().width, out.levels.back().height) > smallest_side)
    out.levels.push_back(half_resolution_heights(out.levels.back()));
  return out;
}

HeightPyramid height_bounds(const HeightLevels& heights, int width, int height) {
  HeightGrid used{width, height, {}};
  used.z.reserve(std::size_t(width) * std::size_t(height));
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) used.z.push_back(heights.levels.front().at(i, j));
  HeightPyramid pyramid = make_height_pyramid(used);
  for (std::size_t k = 1; k < pyramid.levels.size(); ++k) {
    pyramid.levels[k] = coarser_bounds(pyramid.levels[k - 1]);
    if (k < heights.levels.size() && k <= HeightLevels::coarsest_traced)
      include_coarser_field(pyramid.levels[k], heights.levels[k]);
  }
  return pyramid;
}

namespace {

// Linear light, three floats a texel.
struct Plane {
  int width, height;
  std::vector<float> rgb;

  std::size_t index(int i, int j) const { return 3 * (std::size_t(j) * std::size_t(width) + std::size_t(i)); }
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

// Source texels that a coarse texel covers, with box-filter weights.
//
// n texels become h = floor(n / 2), so a coarse one spans n / h texels: 2, or 2 + 1 / h when n is odd. Then
// coarse texel k spans 2k + k / h to 2k + 2 + (k + 1) / h <= 2k + 3: never more than three texels. A side of
// one texel stays one, with weight 1.
struct Coverage {
  int first = 0, count = 0;
  std::array<float, 3> weight = {};
};
Coverage coverage(int k, int half, int whole) {
  const double from = double(k) * whole / half, to = double(k + 1) * whole / half;
  Coverage out;
  out.first = int(from);
  for (int i = out.first; i < to && out.count < 3; ++i)
    out.weight[std::size_t(out.count++)] =
        float((std::min(to, i + 1.0) - std::max(from, double(i))) / (to - from));
  return out;
}

Plane half_resolution_light(const Plane& fine) {
  Plane out{std::max(fine.width / 2, 1), std::max(fine.height / 2, 1), {}};
  out.rgb.assign(3 * std::size_t(out.width) * std::size_t(out.height), 0.0f);
  for (int j = 0; j < out.height; ++j) {
    const Coverage rows = coverage(j, out.height, fine.height);
    for (int i = 0; i < out.width; ++i) {
      const Coverage columns = coverage(i, out.width, fine.width);
      for (int y = 0; y < rows.count; ++y)
        for (int x = 0; x < columns.count; ++x)
          for (std::size_t c = 0; c < 3; ++c)
            out.rgb[out.index(i, j) + c] += rows.weight[std::size_t(y)] * columns.weight[std::size_t(x)] *
                                            fine.rgb[fine.index(columns.first + x, rows.first + y) + c];
    }
  }
  return out;
}

// RGB9E5: three components m of 9 bits and one exponent E of 5 bits mean the values m 2^(E - 15 - 9). With E
// = e + 15 and the brightest component in 0.5..1 times 2^e, its m is 256 to 512; 512, by rounding, does not
// fit and takes the next exponent.
std::uint32_t pack_rgb9e5(const float* rgb) {
  const float brightest = std::max({rgb[0], rgb[1], rgb[2]});
  int e = 0;
  std::frexp(brightest, &e);
  e = std::clamp(e, -15, 15);
  if (std::lround(std::ldexp(brightest, 9 - e)) > 511) ++e;
  const auto mantissa = [&](float x) { return std::uint32_t(std::lround(std::ldexp(x, 9 - e))); };
  return mantissa(rgb[0]) | mantissa(rgb[1]) << 9 | mantissa(rgb[2]) << 18 | std::uint32_t(e + 15) << 27;
}

ColourLevel pack_level(const Plane& plane) {
  ColourLevel out{plane.width, plane.height, {}};
  out.texels.reserve(plane.rgb.size() / 3);
  for (std::size_t k = 0; k < plane.rgb.size(); k += 3) out.texels.push_back(pack_rgb9e5(&plane.rgb[k]));
  return out;
}

}  // namespace

std::vector<ColourLevel> colour_levels(const Image8& srgb) {
  std::vector<ColourLevel> out;
  Plane plane = linear(srgb);
  out.push_back(pack_level(plane));
  while (plane.width > 1 || plane.height > 1) {
    plane = half_resolution_light(plane);
    out.push_back(pack_level(plane));
  }
  return out;
}

namespace {

constexpr gl::TextureFormat fraction = {GL_R16, GL_RED, GL_UNSIGNED_SHORT};
constexpr gl::TextureFormat ten_bits = {GL_RGB10_A2, GL_RGBA, GL_UNSIGNED_INT_2_10_10_10_REV};

std::vector<std::uint16_t> to_depth_fractions(const std::vector<float>& z) {
  std::vector<std::uint16_t> out(z.size());
  std::transform(z.begin(), z.end(), out.begin(),
                 [](float a) { return std::uint16_t(std::min(-a, 65535.0f)); });
  return out;
}

// Ten bits a component. Shaders read the fraction n' = (511 n + 512) / 1023, which is exact for n = 0 and 1:
// the normal of a flat surface decodes exactly.
std::vector<std::uint32_t> pack_normals(const surface::Surface& surface) {
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
  constexpr std::uint32_t unused_texel[] = {0};
  if (image.empty()) return gl::Texture(1, 1, light, unused_texel);
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
  constexpr int border = 2 + (1 << HeightPyramid::max_levels);  // of the heights, and the pyramid's padding
  const int largest = std::max(
      {surface.width() + border, surface.height() + border, surface.colour().width, surface.colour().height});
  if (largest > limit) {
    return fail(
        "renderer",
        fmt::format("a texture of {} x {} texels is too large to draw", surface.width(), surface.height()),
        fmt::format("this driver draws textures up to {} texels wide and high", limit - border));
  }
  SurfaceTextures result;
  result.upload_heights(surface);
  result.normals =
      mipmapped(surface.width(), surface.height(), ten_bits, pack_normals(surface).data(), surface.edge());
  result.colour = colour_texture(surface);
  // A texture with its mips is 4/3 of itself; drivers keep four bytes for a colour.
  const std::size_t texels = std::size_t(surface.width()) * std::size_t(surface.height());
  const std::size_t coloured = surface.colour().data.size() / 3;
  result.bytes += (4 * texels + 4 * coloured) * 4 / 3;
  return result;
}

// The fields on their way to the device are larger than all textures; they are gone at the end.
void SurfaceTextures::upload_heights(const surface::Surface& surface) {
  const HeightLevels fields = make_height_levels(surface);
  heights = gl::Texture(fields.levels[0].width, fields.levels[0].height, fraction, nullptr);
  // Shaders sample one level at a time, so there is no filtering between levels.
  heights.set_filter(GL_LINEAR_MIPMAP_NEAREST, GL_LINEAR);
  int at = 0;
  for (const HeightGrid& level : fields.levels) {
    heights.set_level(at++, level.width, level.height, fraction, to_depth_fractions(level.z).data());
    bytes += 2 * level.z.size();
  }
  // Level 0 is omitted: intersecting a cell's patch costs no more than testing its bound.
  const HeightPyramid pyramid = height_bounds(fields, surface.width() + 2, surface.height() + 2);
  const auto& blocks = pyramid.levels[1];
  bounds = gl::Texture(blocks.width, blocks.height, fraction, nullptr);
  bounds.set_filter(GL_NEAREST_MIPMAP_NEAREST, GL_NEAREST);
  for (auto level = pyramid.levels.begin() + 1; level != pyramid.levels.end(); ++level) {
    bounds.set_level(pyramid_levels++, level->width, level->height, fraction,
                     to_depth_fractions(level->z).data());
    bytes += 2 * level->z.size();
  }
}

}  // namespace intaglio::render
