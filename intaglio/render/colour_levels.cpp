#include "intaglio/render/colour_levels.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace intaglio::render {

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

}  // namespace intaglio::render
