#include "surface/inspect.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "surface/image/image_file.h"

namespace intaglio::surface {

namespace {

constexpr int preview_width = 512;
constexpr double degrees = 180 / std::numbers::pi;

struct Picture {
  int width, height;

  Picture(const Texels& texels, int widest)
      : width(std::min(widest, texels.width)), height(std::max(1, width * texels.height / texels.width)) {}
  // The texel shown by pixel (x, y), row 0 = top.
  std::size_t texel(const Texels& texels, int x, int y) const {
    const int i = x * texels.width / width;
    const int j = (height - 1 - y) * texels.height / height;
    return std::size_t(j) * std::size_t(texels.width) + std::size_t(i);
  }
};

template <class Shade>
Image8 picture(const Texels& texels, int widest, const Shade& shade) {
  const Picture size(texels, widest);
  Image8 image(size.width, size.height, 3);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const Vec3 rgb = shade(x, y, size.texel(texels, x, y));
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) = std::uint8_t(std::lround(255 * std::clamp(rgb[c], 0.0, 1.0)));
    }
  }
  return image;
}

Vec3 colour_at(const Texels& texels, const Picture& size, int x, int y) {
  const Image8& map = texels.colour;
  const int i = x * map.width / size.width;
  const int j = (size.height - 1 - y) * map.height / size.height;
  return Vec3(map.at(i, j, 0), map.at(i, j, 1), map.at(i, j, 2)) / 255.0;
}

void measure_slopes(const Texels& texels, Inspection& out) {
  double sum = 0;
  const double share = 1.0 / double(texels.normal.size());
  for (const Vec3& n : texels.normal) {
    const double slope = std::hypot(n.x(), n.y()) / std::max(n.z(), 1e-6);
    const double angle = std::atan(slope) * degrees;
    sum += std::min(slope, max_slope) * std::min(slope, max_slope);
    const auto bin = std::min(std::size_t(angle / Inspection::bin_degrees), out.slope_histogram.size() - 1);
    out.slope_histogram[bin] += share;
    if (angle > 45) out.steep_fraction += share;
    if (angle > 70) out.near_vertical_fraction += share;
  }
  out.rms_slope = std::sqrt(sum * share);
}

// Counts the levels used by the height file. Without a file the height was generated at full precision.
Result<void> measure_terraces(Inspection& out) {
  if (out.report.height_file.empty()) return {};
  const auto image = read_image(out.report.height_file);
  if (!image) return tl::unexpected(image.error());
  std::set<float> levels;
  const auto channels = std::size_t(image->pixels.channels);
  for (std::size_t p = std::size_t(out.report.height_channel); p < image->pixels.data.size(); p += channels)
    levels.insert(image->pixels.data[p]);
  out.height_levels = int(levels.size());
  if (levels.size() > 1) {
    const double step = double(*levels.rbegin() - *levels.begin()) / double(levels.size() - 1);
    out.terrace_slope = step * out.depth_fraction * out.width;
  }
  return {};
}

void advise(Inspection& out) {
  if (out.rms_slope < 0.02) {
    out.representation = "flat";
    out.reason = "slopes are too small to notice; only colour matters";
  } else if (out.near_vertical_fraction > 0.02) {
    out.representation = "normal";
    out.reason = fmt::format(
        "{:.1f} % of the surface is near-vertical; participants preferred the normal map on such surfaces "
        "(the paper's surface 5)",
        100 * out.near_vertical_fraction);
  } else if (!out.has_height && out.report.curl > 0.5) {
    out.representation = "normal";
    out.reason = fmt::format(
        "{:.0f} % of the normals' slope is not integrable, so a derived relief would differ from the normal "
        "map",
        100 * out.report.curl);
  } else {
    out.representation = "relief";
    out.reason = "slopes are moderate and consistent with a height, so a relief keeps all senses consistent";
  }
}

}  // namespace

Image8 relit_preview(const Texels& texels, int width) {
  const Picture size(texels, width);
  const Vec3 light = Vec3(-0.5, 0.5, 0.6).normalized();
  return picture(texels, width, [&](int x, int y, std::size_t k) -> Vec3 {
    const double lit = 0.18 + 1.25 * std::max(0.0, texels.normal[k].dot(light));
    return colour_at(texels, size, x, y) * lit;
  });
}

Result<Inspection> inspect(const std::filesystem::path& path, const ImportOptions& options) {
  auto imported = import_texture(path, options);
  if (!imported) return tl::unexpected(imported.error());
  const Texels& texels = imported->texels;
  Inspection out;
  out.width = texels.width;
  out.height = texels.height;
  out.report = imported->report;
  out.has_normals = out.report.generated || !out.report.normal_file.empty();
  out.has_height = out.report.generated || !out.report.height_file.empty();
  out.depth_fraction = imported->depth_fraction;
  out.notes = std::move(imported->notes);
  out.warnings = std::move(imported->warnings);
  measure_slopes(texels, out);
  if (auto measured = measure_terraces(out); !measured) return tl::unexpected(measured.error());
  if (out.terrace_slope > 0.1)
    out.notes.push_back(
        fmt::format("the height has {} levels: a step is a slope of {:.0f} degrees over one texel; fusion "
                    "with the normals smooths that",
                    out.height_levels, std::atan(out.terrace_slope) * degrees));
  advise(out);
  const Picture size(texels, preview_width);
  out.colour = picture(texels, preview_width,
                       [&](int x, int y, std::size_t) { return colour_at(texels, size, x, y); });
  out.height_map = picture(texels, preview_width, [&](int, int, std::size_t k) -> Vec3 {
    return Vec3::Constant(texels.depth.empty() ? 0.5 : 1 - double(texels.depth[k]));
  });
  out.normal_map = picture(texels, preview_width, [&](int, int, std::size_t k) -> Vec3 {
    return 0.5 * texels.normal[k] + Vec3::Constant(0.5);
  });
  out.preview = relit_preview(texels, preview_width);
  return out;
}

}  // namespace intaglio::surface
