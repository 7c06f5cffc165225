#include "evaluate/flip.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "core/portable_math.h"
#include "intaglio/vec.h"

namespace intaglio::evaluate {
namespace {

using Plane = std::vector<double>;
using Planes = std::array<Plane, 3>;

struct PictureSize {
  int width, height;

  std::size_t pixels() const { return std::size_t(width) * std::size_t(height); }
};

// The paper's constants: colour exponent, remap, feature width in degrees and exponent.
constexpr double colour_exponent = 0.7;
constexpr double remap_at = 0.4, remap_to = 0.95;
constexpr double feature_width = 0.082;

// From linear sRGB to CIE XYZ, by the chromaticities of sRGB's primaries and of D65.
const Mat3& xyz_from_rgb() {
  static const Mat3 matrix = (Mat3() << 10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794,
                              2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897,
                              1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382)
                                 .finished();
  return matrix;
}

// XYZ as fractions of white's, and back to linear sRGB.
struct ColourSpace {
  Mat3 relative_from_rgb, rgb_from_relative;

  ColourSpace() {
    const Vec3 white = xyz_from_rgb() * Vec3(1, 1, 1);
    relative_from_rgb = white.cwiseInverse().asDiagonal() * xyz_from_rgb();
    rgb_from_relative = relative_from_rgb.inverse();
  }
};

const ColourSpace& colour_space() {
  static const ColourSpace space;
  return space;
}

// CIELAB's linearised variant, in which filtering is linear: an achromatic and two opponent channels.
Vec3 opponent_of(const Vec3& rgb) {
  const Vec3 xyz = colour_space().relative_from_rgb * rgb;
  return {116 * xyz[1] - 16, 500 * (xyz[0] - xyz[1]), 200 * (xyz[1] - xyz[2])};
}

Vec3 rgb_of_opponent(const Vec3& opponent) {
  const double y = (opponent[0] + 16) / 116;
  return colour_space().rgb_from_relative * Vec3(y + opponent[1] / 500, y, y - opponent[2] / 200);
}

double lab_curve(double t) {
  constexpr double delta = 6.0 / 29;
  return t > delta * delta * delta ? elementary::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
}

// CIELAB whose chroma grows with lightness, as Hunt found.
Vec3 hunt_lab_of(const Vec3& rgb) {
  const Vec3 xyz = colour_space().relative_from_rgb * rgb;
  const double x = lab_curve(xyz[0]), y = lab_curve(xyz[1]), z = lab_curve(xyz[2]);
  const double lightness = 116 * y - 16;
  return {lightness, 0.01 * lightness * 500 * (x - y), 0.01 * lightness * 200 * (y - z)};
}

double hyab(const Vec3& a, const Vec3& b) {
  return std::abs(a[0] - b[0]) + elementary::hypot(a[1] - b[1], a[2] - b[2]);
}

// The greatest difference within sRGB.
double greatest_difference() {
  return elementary::pow(hyab(hunt_lab_of({0, 1, 0}), hunt_lab_of({0, 0, 1})), colour_exponent);
}

// Spends the upper 5 % of the range on differences that are large anyhow.
double remapped(double difference, double greatest) {
  const double knee = remap_at * greatest;
  if (difference < knee) return remap_to / knee * difference;
  return remap_to + (difference - knee) / (greatest - knee) * (1 - remap_to);
}

std::array<double, 256> decoded_srgb() {
  std::array<double, 256> linear{};
  for (int k = 0; k < 256; ++k) {
    const double s = k / 255.0;
    linear[std::size_t(k)] = s <= 0.04045 ? s / 12.92 : elementary::pow((s + 0.055) / 1.055, 2.4);
  }
  return linear;
}

Planes opponent_planes(const Image8& picture) {
  const auto linear = decoded_srgb();
  const PictureSize size{picture.width, picture.height};
  Planes planes;
  for (Plane& plane : planes) plane.resize(size.pixels());
  for (std::size_t k = 0; k < size.pixels(); ++k) {
    const std::uint8_t* pixel = &picture.data[k * std::size_t(picture.channels)];
    const Vec3 opponent = opponent_of({linear[pixel[0]], linear[pixel[1]], linear[pixel[2]]});
    for (std::size_t c = 0; c < 3; ++c) planes[c][k] = opponent[int(c)];
  }
  return planes;
}

// Taps from -radius to radius.
using Kernel = std::vector<double>;

// Correlates the rows with `across`, then the columns with `down`; borders repeat their value.
Plane filtered(const Plane& plane, PictureSize size, const Kernel& across, const Kernel& down) {
  const int radius = int(across.size() / 2);
  const auto width = std::size_t(size.width);
  Plane rows(plane.size(), 0), result(plane.size(), 0), padded(width + across.size() - 1);
  for (std::size_t y = 0; y < std::size_t(size.height); ++y) {
    const double* in = &plane[y * width];
    double* out = &rows[y * width];
    for (int x = 0; x < int(padded.size()); ++x)
      padded[std::size_t(x)] = in[std::clamp(x - radius, 0, size.width - 1)];
    for (std::size_t tap = 0; tap < across.size(); ++tap)
      for (std::size_t x = 0; x < width; ++x) out[x] += across[tap] * padded[x + tap];
  }
  const int reach = int(down.size() / 2);
  for (int y = 0; y < size.height; ++y) {
    double* out = &result[std::size_t(y) * width];
    for (int tap = -reach; tap <= reach; ++tap) {
      const double* in = &rows[std::size_t(std::clamp(y + tap, 0, size.height - 1)) * width];
      const double weight = down[std::size_t(tap + reach)];
      for (std::size_t x = 0; x < width; ++x) out[x] += weight * in[x];
    }
  }
  return result;
}

// --- The colour part ---

// One Gaussian of a contrast sensitivity function: a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees.
struct SensitivityTerm {
  double a, b;
};
constexpr double widest_term = 0.04;
// Achromatic, red-green and blue-yellow.
constexpr SensitivityTerm achromatic_terms[] = {{1, 0.0047}}, red_green_terms[] = {{1, 0.0053}};
constexpr SensitivityTerm blue_yellow_terms[] = {{34.1, widest_term}, {13.5, 0.025}};
constexpr std::span<const SensitivityTerm> sensitivity[] = {achromatic_terms, red_green_terms,
                                                            blue_yellow_terms};

// The channel behind its contrast sensitivity. Each Gaussian is separable, and their sum has weight 1.
Plane filtered_by_sensitivity(const Plane& plane, PictureSize size, std::span<const SensitivityTerm> terms,
                              double pixels_per_degree) {
  constexpr double pi = std::numbers::pi;
  const int radius = int(std::ceil(3 * std::sqrt(widest_term / (2 * pi * pi)) * pixels_per_degree));
  std::vector<Kernel> kernels;
  std::vector<double> weights;
  double total = 0;
  for (const auto& [a, b] : terms) {
    Kernel kernel;
    double sum = 0;
    for (int k = -radius; k <= radius; ++k) {
      const double degrees = k / pixels_per_degree;
      kernel.push_back(elementary::exp(-pi * pi * degrees * degrees / b));
      sum += kernel.back();
    }
    for (double& tap : kernel) tap /= sum;
    kernels.push_back(std::move(kernel));
    weights.push_back(a * std::sqrt(pi / b) * sum * sum);
    total += weights.back();
  }
  Plane result(plane.size(), 0);
  for (std::size_t t = 0; t < terms.size(); ++t) {
    const Plane one = filtered(plane, size, kernels[t], kernels[t]);
    for (std::size_t k = 0; k < result.size(); ++k) result[k] += weights[t] / total * one[k];
  }
  return result;
}

// The colours that the eye resolves, as Hunt's CIELAB.
Planes seen_colours(const Planes& opponent, PictureSize size, double pixels_per_degree) {
  Planes planes;
  for (std::size_t c = 0; c < 3; ++c)
    planes[c] = filtered_by_sensitivity(opponent[c], size, sensitivity[c], pixels_per_degree);
  for (std::size_t k = 0; k < size.pixels(); ++k) {
    const Vec3 rgb = rgb_of_opponent({planes[0][k], planes[1][k], planes[2][k]});
    const Vec3 lab = hunt_lab_of(rgb.cwiseMax(0.0).cwiseMin(1.0));
    for (std::size_t c = 0; c < 3; ++c) planes[c][k] = lab[int(c)];
  }
  return planes;
}

// --- The feature part ---

struct FeaturePlanes {
  Plane edges, points;  // magnitudes
};

// Scales the positive taps to a sum of 1 and the negative ones to -1.
void balance(Kernel& kernel) {
  double positive = 0, negative = 0;
  for (const double tap : kernel) (tap > 0 ? positive : negative) += tap;
  for (double& tap : kernel) tap /= tap > 0 ? positive : -negative;
}

FeaturePlanes features_of(const Plane& achromatic, PictureSize size, double pixels_per_degree) {
  const double deviation = 0.5 * feature_width * pixels_per_degree;
  const int radius = int(std::ceil(3 * deviation));
  Kernel smooth, edge, point;
  double sum = 0;
  for (int k = -radius; k <= radius; ++k) {
    const double square = k * double(k) / (deviation * deviation);
    const double gauss = elementary::exp(-0.5 * square);
    smooth.push_back(gauss);
    edge.push_back(-k * gauss);
    point.push_back((square - 1) * gauss);
    sum += gauss;
  }
  for (double& tap : smooth) tap /= sum;
  balance(edge);
  balance(point);
  Plane lightness(achromatic.size());
  for (std::size_t k = 0; k < lightness.size(); ++k) lightness[k] = (achromatic[k] + 16) / 116;
  const auto magnitude = [&](const Kernel& kernel) {
    Plane across = filtered(lightness, size, kernel, smooth);
    const Plane down = filtered(lightness, size, smooth, kernel);
    for (std::size_t k = 0; k < across.size(); ++k) across[k] = elementary::hypot(across[k], down[k]);
    return across;
  };
  return {magnitude(edge), magnitude(point)};
}

Result<void> check(const Image8& reference, const Image8& test, double pixels_per_degree) {
  if (reference.width != test.width || reference.height != test.height)
    return fail("",
                fmt::format("the pictures have {} x {} and {} x {} pixels", reference.width, reference.height,
                            test.width, test.height),
                "FLIP compares pictures of equal size");
  if (reference.width < 1 || reference.height < 1)
    return fail("", "the pictures have no pixels", "FLIP compares pictures of at least one pixel");
  for (const Image8* picture : {&reference, &test})
    if (picture->channels != 3 && picture->channels != 4)
      return fail("", fmt::format("a picture has {} channels", picture->channels),
                  "FLIP compares RGB or RGBA");
  if (!(pixels_per_degree >= 1 && pixels_per_degree <= 1000))
    return fail("", fmt::format("{} pixels per degree", pixels_per_degree),
                "pixels per degree must be 1 to 1000");
  return {};
}

}  // namespace

double pixels_per_degree_of(double distance, double pixels, double width) {
  return distance * pixels / width * std::numbers::pi / 180;
}

Result<FlipMap> flip(const Image8& reference, const Image8& test, double pixels_per_degree) {
  if (auto checked = check(reference, test, pixels_per_degree); !checked)
    return tl::unexpected(std::move(checked).error());
  const PictureSize size{reference.width, reference.height};
  std::array<Planes, 2> seen;
  std::array<FeaturePlanes, 2> features;
  for (std::size_t p = 0; p < 2; ++p) {
    const Planes opponent = opponent_planes(p == 0 ? reference : test);
    features[p] = features_of(opponent[0], size, pixels_per_degree);
    seen[p] = seen_colours(opponent, size, pixels_per_degree);
  }
  const double greatest = greatest_difference();
  FlipMap map{Image<float>(size.width, size.height, 1), 0};
  for (std::size_t k = 0; k < size.pixels(); ++k) {
    const double distance =
        hyab({seen[0][0][k], seen[0][1][k], seen[0][2][k]}, {seen[1][0][k], seen[1][1][k], seen[1][2][k]});
    const double colour = remapped(elementary::pow(distance, colour_exponent), greatest);
    const double edge = std::abs(features[0].edges[k] - features[1].edges[k]);
    const double point = std::abs(features[0].points[k] - features[1].points[k]);
    const double feature = std::sqrt(std::max(edge, point) / std::numbers::sqrt2);
    const double error = elementary::pow(colour, 1 - feature);
    map.error.data[k] = float(error);
    map.mean += error;
  }
  map.mean /= double(size.pixels());
  return map;
}

}  // namespace intaglio::evaluate
