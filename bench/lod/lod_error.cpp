#include "bench/lod/lod_error.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/fourier.h"
#include "core/portable_math.h"

namespace intaglio::bench {

namespace {

constexpr double ball_radius = 0.1;  // m
constexpr int balls = 4000, strokes = 96, stroke_samples = 512;
constexpr double border = 0.05;  // share of the side, left out of every comparison
// Bins of a stroke's spectrum: the finest wave of a texture is two texels, which are four samples of the
// raster.
constexpr int first_bin = 2, last_bin = stroke_samples / 4;
constexpr double quietest = 1e-6;  // bands 60 dB below the loudest one are not compared

double height_at(const HeightRaster& r, double x, double y) {
  const double u = x / r.length * r.side - 0.5, v = y / r.length * r.side - 0.5;
  const int i = std::clamp(int(u), 0, r.side - 2), j = std::clamp(int(v), 0, r.side - 2);
  const double s = u - i, t = v - j;
  const double low = (1 - s) * double(r.z[r.at(i, j)]) + s * double(r.z[r.at(i + 1, j)]);
  const double high = (1 - s) * double(r.z[r.at(i, j + 1)]) + s * double(r.z[r.at(i + 1, j + 1)]);
  return (1 - t) * low + t * high;
}

double ball_over(const HeightRaster& r, int i, int j) {
  const double step = r.length / r.side;
  const int reach = int(ball_radius / step);
  double best = -1e9;
  for (int y = std::max(-reach, -j); y <= std::min(reach, r.side - 1 - j); ++y) {
    for (int x = std::max(-reach, -i); x <= std::min(reach, r.side - 1 - i); ++x) {
      const double square = ball_radius * ball_radius - (x * x + y * y) * step * step;
      if (square >= 0) best = std::max(best, double(r.z[r.at(i + x, j + y)]) + std::sqrt(square));
    }
  }
  return best;
}

std::vector<double> ball_heights(const HeightRaster& r) {
  Random random(5);
  std::vector<double> out;
  for (int k = 0; k < balls; ++k) {
    const int i = int(random.uniform(border, 1 - border) * r.side);
    const int j = int(random.uniform(border, 1 - border) * r.side);
    out.push_back(ball_over(r, i, j));
  }
  return out;
}

// Mean power of the slope along the strokes, of each third of an octave.
std::vector<double> stroke_bands(const HeightRaster& r) {
  Random random(6);
  Fourier<double> transform(stroke_samples, false);
  std::vector<double> power(stroke_samples / 2, 0.0);
  const double step = r.length / r.side, inside = (1 - 2 * border) * r.length;
  for (int k = 0; k < strokes;) {
    const double x = border * r.length + inside * random.uniform();
    const double y = border * r.length + inside * random.uniform();
    const double angle = random.uniform(0, 2 * std::numbers::pi);
    const double along_x = step * std::cos(angle), along_y = step * std::sin(angle);
    const double end_x = x + stroke_samples * along_x, end_y = y + stroke_samples * along_y;
    const auto is_inside = [&](double a) { return a > border * r.length && a < (1 - border) * r.length; };
    if (!is_inside(end_x) || !is_inside(end_y)) continue;
    ++k;
    std::vector<std::complex<double>> slope, spectrum(stroke_samples);
    for (int n = 0; n < stroke_samples; ++n) {
      const double rise = height_at(r, x + (n + 1) * along_x, y + (n + 1) * along_y) -
                          height_at(r, x + n * along_x, y + n * along_y);
      const double window = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * (n + 0.5) / stroke_samples);
      slope.emplace_back(window * rise / step, 0);
    }
    transform(spectrum.data(), slope.data());
    for (std::size_t bin = 0; bin < power.size(); ++bin) power[bin] += std::norm(spectrum[bin]);
  }
  std::vector<double> bands;
  for (double low = first_bin; low < last_bin; low *= std::cbrt(2.0)) {
    double sum = 0;
    for (int bin = int(std::ceil(low)); bin < std::min(low * std::cbrt(2.0), double(last_bin)); ++bin)
      sum += power[std::size_t(bin)];
    if (sum > 0) bands.push_back(sum);
  }
  return bands;
}

// The sample under a triangle, and its corners' weights there.
template <class Visit>
void for_each_sample(const LodMesh& mesh, const std::array<int, 3>& triangle, double step, int side,
                     const Visit& visit) {
  const Vec3 &a = mesh.positions[std::size_t(triangle[0])], &b = mesh.positions[std::size_t(triangle[1])],
             &c = mesh.positions[std::size_t(triangle[2])];
  const double area = (b.x() - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (b.y() - a.y());
  if (std::abs(area) < 1e-15) return;
  const auto first = [&](double low) { return std::max(0, int(std::ceil(low / step - 0.5))); };
  const auto last = [&](double high) { return std::min(side - 1, int(std::floor(high / step - 0.5))); };
  for (int j = first(std::min({a.y(), b.y(), c.y()})); j <= last(std::max({a.y(), b.y(), c.y()})); ++j) {
    for (int i = first(std::min({a.x(), b.x(), c.x()})); i <= last(std::max({a.x(), b.x(), c.x()})); ++i) {
      const double x = (i + 0.5) * step, y = (j + 0.5) * step;
      const double wb = ((x - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (y - a.y())) / area;
      const double wc = ((b.x() - a.x()) * (y - a.y()) - (x - a.x()) * (b.y() - a.y())) / area;
      if (wb >= -1e-9 && wc >= -1e-9 && wb + wc <= 1 + 1e-9) visit(i, j, Vec3(1 - wb - wc, wb, wc));
    }
  }
}

}  // namespace

HeightRaster raster_of(const surface::Surface& surface, int side) {
  HeightRaster out{side, surface.placement().size_u(), {}, {}};
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      const Vec2 uv((i + 0.5) / side, (j + 0.5) / side);
      out.z.push_back(float(-surface.depth(uv)));
      out.normal.push_back(surface.normal(uv).cast<float>());
    }
  }
  return out;
}

HeightRaster raster_of(const LodMesh& mesh, double length, int side) {
  const std::size_t count = std::size_t(side) * std::size_t(side);
  HeightRaster out{side, length, std::vector<float>(count, -1e9F),
                   std::vector<Eigen::Vector3f>(count, Eigen::Vector3f::UnitZ())};
  for (const auto& triangle : mesh.triangles) {
    for_each_sample(mesh, triangle, length / side, side, [&](int i, int j, const Vec3& weights) {
      double z = 0;
      Vec3 normal = Vec3::Zero();
      for (int corner = 0; corner < 3; ++corner) {
        const auto vertex = std::size_t(triangle[std::size_t(corner)]);
        z += weights[corner] * mesh.positions[vertex].z();
        normal += weights[corner] * mesh.normals[vertex];
      }
      const std::size_t at = out.at(i, j);
      if (float(z) <= out.z[at]) return;
      out.z[at] = float(z);
      out.normal[at] = normal.normalized().cast<float>();
    });
  }
  return out;
}

LodErrors::LodErrors(HeightRaster full)
    : full_(std::move(full)), balls_(ball_heights(full_)), bands_(stroke_bands(full_)) {}

LodError LodErrors::of(const HeightRaster& other) const {
  LodError out;
  double angle = 0, depth = 0, count = 0;
  const int first = int(border * full_.side), last = full_.side - first;
  for (int j = first; j < last; ++j) {
    for (int i = first; i < last; ++i, ++count) {
      const std::size_t k = full_.at(i, j);
      // The cosine is too rough where vectors are nearly equal.
      const double chord = double((full_.normal[k] - other.normal[k]).norm());
      const double between = 2 * std::asin(std::min(1.0, chord / 2));
      angle += between * between;
      depth += std::pow(double(full_.z[k]) - double(other.z[k]), 2);
    }
  }
  out.normal_deg = std::sqrt(angle / count) * 180 / std::numbers::pi;
  out.depth_mm = 1e3 * std::sqrt(depth / count);
  const std::vector<double> heights = ball_heights(other), bands = stroke_bands(other);
  double square = 0;
  for (std::size_t k = 0; k < heights.size(); ++k) square += std::pow(heights[k] - balls_[k], 2);
  out.ball_mm = 1e3 * std::sqrt(square / double(heights.size()));
  const double floor = quietest * *std::max_element(bands_.begin(), bands_.end());
  square = 0;
  for (std::size_t k = 0; k < bands.size(); ++k)
    square += std::pow(10 * std::log10((bands[k] + floor) / (bands_[k] + floor)), 2);
  out.sound_db = std::sqrt(square / double(bands.size()));
  return out;
}

}  // namespace intaglio::bench
