#include "surface/fuse.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "core/fourier.h"
#include "core/portable_math.h"

namespace intaglio::surface {

void fft2(std::vector<std::complex<float>>& data, int width, int height, Transform transform) {
  using Complex = std::complex<float>;
  Fourier<float> row(width, transform == Transform::inverse), column(height, transform == Transform::inverse);
  const auto w = std::size_t(width), h = std::size_t(height);
  std::vector<Complex> line(w), spectrum(w);
  for (std::size_t y = 0; y < h; ++y) {
    std::copy_n(data.begin() + std::ptrdiff_t(y * w), w, line.begin());
    row(data.data() + y * w, line.data());
  }
  // Columns, sixteen at a time: each row then costs one cache line for sixteen values.
  constexpr std::size_t batch = 16;
  std::vector<Complex> columns(h * batch), out(h);
  for (std::size_t x0 = 0; x0 < w; x0 += batch) {
    const std::size_t n = std::min(batch, w - x0);
    for (std::size_t y = 0; y < h; ++y) {
      for (std::size_t k = 0; k < n; ++k) columns[k * h + y] = data[y * w + x0 + k];
    }
    for (std::size_t k = 0; k < n; ++k) {
      column(out.data(), columns.data() + k * h);
      std::copy(out.begin(), out.end(), columns.begin() + std::ptrdiff_t(k * h));
    }
    for (std::size_t y = 0; y < h; ++y) {
      for (std::size_t k = 0; k < n; ++k) data[y * w + x0 + k] = columns[k * h + y];
    }
  }
}

namespace {

using Complex = std::complex<float>;
using Spectrum = std::vector<Complex>;

// The tile as it is, or mirrored to twice its size. Slopes across a mirror change sign.
struct PaddedTile {
  int width, height;
  bool mirrored;

  template <class Value>
  Spectrum padded(const Value& value) const {
    Spectrum out(std::size_t(width) * std::size_t(height));
    const int w = mirrored ? width / 2 : width;
    const int h = mirrored ? height / 2 : height;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const bool mirrored_x = x >= w;
        const bool mirrored_y = y >= h;
        out[std::size_t(y) * std::size_t(width) + std::size_t(x)] =
            value(mirrored_x ? 2 * w - 1 - x : x, mirrored_y ? 2 * h - 1 - y : y, mirrored_x ? -1.0f : 1.0f,
                  mirrored_y ? -1.0f : 1.0f);
      }
    }
    return out;
  }
};

// Derivative operator along one axis in the Fourier domain, without the factor i.
using Derivative = std::vector<double>;

Derivative derivative(int n, bool central) {
  Derivative d;
  d.resize(std::size_t(n));
  for (int k = 0; k < n; ++k) {
    const int signed_k = 2 * k < n ? k : k - n;
    const double omega = 2 * std::numbers::pi * signed_k / n;
    // The Nyquist frequency of a real field has no derivative.
    d[std::size_t(k)] = 2 * k == n ? 0 : central ? elementary::sin(omega) : omega;
  }
  return d;
}

// One frequency of the problem. Both slopes, which are real, share one transform as x + i y: with A its value
// here and B that at the opposite frequency, their spectra are (A + conj B) / 2 and (A - conj B) / 2i.
struct Frequency {
  std::size_t index, opposite;
  double dx, dy;

  double power() const { return dx * dx + dy * dy; }
  std::pair<Complex, Complex> slopes(const Spectrum& packed) const {
    const Complex a = packed[index];
    const Complex b = std::conj(packed[opposite]);
    return {0.5f * (a + b), Complex(0, -0.5f) * (a - b)};
  }
};

template <class Visit>
void for_each_frequency(int width, int height, const Derivative& x_axis, const Derivative& y_axis,
                        const Visit& visit) {
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      const auto at = [&](int a, int b) { return std::size_t(b) * std::size_t(width) + std::size_t(a); };
      visit(Frequency{at(i, j), at((width - i) % width, (height - j) % height), x_axis[std::size_t(i)],
                      y_axis[std::size_t(j)]});
    }
  }
}

struct Noise {
  double height, slope;  // power per texel
};

// Misfit of the normals to the height's derivative under this discretisation, in units of the noise, at
// frequencies where the height exceeds its own noise.
double misfit(int width, int height, const Derivative& x_axis, const Derivative& y_axis,
              const Spectrum& packed, const Spectrum& h0, const Noise& noise) {
  const double texels = double(width) * height;
  double sum = 0;
  for_each_frequency(width, height, x_axis, y_axis, [&](const Frequency& f) {
    const Complex h = h0[f.index];
    if (std::norm(h) < 100 * texels * noise.height) return;
    const auto [p, q] = f.slopes(packed);
    const Complex dx(0, float(f.dx));
    const Complex dy(0, float(f.dy));
    sum += (std::norm(p - dx * h) + std::norm(q - dy * h)) / (2 * noise.slope + f.power() * noise.height);
  });
  return sum;
}

double mean(const Field& field) {
  double sum = 0;
  for (const float v : field.value) sum += v;
  return field.empty() ? 0 : sum / double(field.value.size());
}

}  // namespace

double slope_noise(const Slopes& slopes, double step) {
  double sum = 0;
  for (std::size_t k = 0; k < slopes.x.value.size(); ++k) {
    const double p = slopes.x.value[k];
    const double q = slopes.y.value[k];
    const double s2 = p * p + q * q;
    sum += (1 + s2) * (1 + 0.5 * s2);
  }
  return step * step / 12 * sum / double(std::max<std::size_t>(1, slopes.x.value.size()));
}

namespace {

// The input in the Fourier domain.
struct Problem {
  PaddedTile tile;
  Spectrum packed;  // of both slopes
  Spectrum h0;      // of the height map; empty without one
  Derivative x_axis, y_axis;
  double lambda = 0;
};

Problem transformed(const FuseInput& input) {
  const Field &px = input.slopes.x, &py = input.slopes.y;
  const bool mirrored = input.edge == FuseEdge::mirrored;
  const int factor = mirrored ? 2 : 1;
  Problem out{{factor * px.width, factor * px.height, mirrored}, {}, {}, {}, {}};
  out.packed = out.tile.padded(
      [&](int x, int y, float sx, float sy) { return Complex(sx * px.at(x, y), sy * py.at(x, y)); });
  fft2(out.packed, out.tile.width, out.tile.height, Transform::forward);
  if (!input.height.empty()) {
    out.h0 = out.tile.padded([&](int x, int y, float, float) { return Complex(input.height.at(x, y), 0); });
    fft2(out.h0, out.tile.width, out.tile.height, Transform::forward);
  }
  out.x_axis = derivative(out.tile.width, false);
  out.y_axis = derivative(out.tile.height, false);
  return out;
}

// Chooses lambda and the discretisation of the derivative. Normals baked from finer geometry have the exact
// derivative; normals made from the height map itself have central differences.
void fit_to_height(const FuseInput& input, Problem& problem) {
  const Noise noise{std::max(1e-12, input.height_step * input.height_step / 12),
                    slope_noise(input.slopes, std::max(1e-6, input.normal_step))};
  problem.lambda = noise.slope / noise.height;
  const int width = problem.tile.width, height = problem.tile.height;
  Derivative x_central = derivative(width, true), y_central = derivative(height, true);
  const auto cost = [&](const Derivative& x, const Derivative& y) {
    return misfit(width, height, x, y, problem.packed, problem.h0, noise);
  };
  if (cost(x_central, y_central) < cost(problem.x_axis, problem.y_axis)) {
    problem.x_axis = std::move(x_central);
    problem.y_axis = std::move(y_central);
  }
}

struct Solution {
  Spectrum height, slopes;  // the slopes packed as in Problem
  double curl;
};

// Minimises |i dx H - P|^2 + |i dy H - Q|^2 + lambda |H - H0|^2 for each frequency, with P and Q the spectra
// of the slopes. Setting the derivative by conj H to zero,
//   H = (-i dx P - i dy Q + lambda H0) / (dx^2 + dy^2 + lambda).
// The component of (P, Q) orthogonal to (dx, dy) has no height; its power is |dx Q - dy P|^2 / (dx^2 + dy^2).
Solution solve(const Problem& problem) {
  Solution out{Spectrum(problem.packed.size()), Spectrum(problem.packed.size()), 0};
  double total_power = 0, rotational_power = 0;
  const auto visit = [&](const Frequency& f) {
    const auto [p, q] = f.slopes(problem.packed);
    const double power = f.power();
    const float dx = float(f.dx), dy = float(f.dy);
    Complex numerator = Complex(0, -dx) * p + Complex(0, -dy) * q;
    if (power > 0) {
      total_power += std::norm(p) + std::norm(q);
      rotational_power += std::norm(dx * q - dy * p) / power;
    }
    if (!problem.h0.empty()) numerator += float(problem.lambda) * problem.h0[f.index];
    const double denominator = power + problem.lambda;
    const Complex h = denominator > 1e-12 ? numerator / float(denominator) : Complex(0, 0);
    out.height[f.index] = h;
    out.slopes[f.index] = Complex(0, dx) * h + Complex(0, 1) * (Complex(0, dy) * h);
  };
  for_each_frequency(problem.tile.width, problem.tile.height, problem.x_axis, problem.y_axis, visit);
  out.curl = total_power > 0 ? std::sqrt(rotational_power / total_power) : 0;
  return out;
}

}  // namespace

Fused fuse(FuseInput input) {
  const int width = input.slopes.x.width, height = input.slopes.x.height;
  const Vec2 mean_slope(mean(input.slopes.x), mean(input.slopes.y));
  Problem problem = transformed(input);
  if (!input.height.empty()) fit_to_height(input, problem);
  input = {};  // the maps are no longer needed, and memory is shortest in solve()
  Solution solution = solve(problem);
  problem.packed = {};
  problem.h0 = {};
  const PaddedTile& tile = problem.tile;
  fft2(solution.height, tile.width, tile.height, Transform::inverse);
  fft2(solution.slopes, tile.width, tile.height, Transform::inverse);
  Fused out{Field(width, height), {Field(width, height), Field(width, height)}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t from = std::size_t(y) * std::size_t(tile.width) + std::size_t(x);
      out.height.at(x, y) = solution.height[from].real();
      out.slopes.x.at(x, y) = solution.slopes[from].real();
      out.slopes.y.at(x, y) = solution.slopes[from].imag();
    }
  }
  out.lambda = problem.lambda;
  out.curl = solution.curl;
  out.mean_slope_x = mean_slope.x();
  out.mean_slope_y = mean_slope.y();
  return out;
}

namespace {

constexpr double min_mean_slope = 1e-3;

// Height differences between neighbouring texels according to the normals, metres, without their mean, which
// is kept apart.
struct TexelSteps {
  Slopes slopes;
  Vec2 mean = Vec2::Zero();
};

TexelSteps texel_steps(const Surface& map) {
  const int w = map.width(), h = map.height();
  const std::vector<float> normals = map.normal_texture();
  TexelSteps out{{Field(w, h), Field(w, h)}, Vec2::Zero()};
  for (std::size_t k = 0; k < out.slopes.x.value.size(); ++k) {
    const Vec2 slope = slope_of(Vec3(normals[3 * k], normals[3 * k + 1], normals[3 * k + 2]));
    const Vec2 d(slope.x() * map.texel_u(), slope.y() * map.texel_v());
    out.slopes.x.value[k] = float(d.x());
    out.slopes.y.value[k] = float(d.y());
    out.mean += d;
  }
  out.mean /= double(out.slopes.x.value.size());
  for (float& d : out.slopes.x.value) d -= float(out.mean.x());
  for (float& d : out.slopes.y.value) d -= float(out.mean.y());
  return out;
}

Placement moved_up(const Placement& place, double by) {
  Mat3 axes;
  axes << place.t(), place.n(), -place.b();
  const Vec3 centre = place.to_world({place.size_u() / 2, place.size_v() / 2, by});
  return {centre, Quat(axes), place.size_u(), place.size_v()};
}

}  // namespace

ImpliedRelief implied_relief(const Surface& map) {
  TexelSteps steps = texel_steps(map);
  FuseInput input;
  input.slopes = std::move(steps.slopes);  // metres per texel, so that fuse() gives metres
  input.edge = map.edge() == Edge::wrap ? FuseEdge::periodic : FuseEdge::mirrored;
  Field height = fuse(std::move(input)).height;

  ImpliedRelief out;
  const Vec2 mean(steps.mean.x() / map.texel_u(), steps.mean.y() / map.texel_v());
  if (mean.norm() > min_mean_slope) out.mean_slope = mean;
  std::vector<double> z(height.value.begin(), height.value.end());
  for (int j = 0; j < height.height; ++j) {
    for (int i = 0; i < height.width; ++i) {
      const Vec2 from_middle((i + 0.5 - 0.5 * height.width) * map.texel_u(),
                             (j + 0.5 - 0.5 * height.height) * map.texel_v());
      z[std::size_t(j) * std::size_t(height.width) + std::size_t(i)] += out.mean_slope.dot(from_middle);
    }
  }
  const auto [low, high] = std::minmax_element(z.begin(), z.end());
  const double range = *high - *low, top = *high;
  Texels texels;
  texels.width = map.width();
  texels.height = map.height();
  const std::vector<float> normals = map.normal_texture();
  for (std::size_t k = 0; k < z.size(); ++k) {
    texels.depth.push_back(range > 0 ? float((top - z[k]) / range) : 0);
    texels.normal.push_back(Vec3(normals[3 * k], normals[3 * k + 1], normals[3 * k + 2]).normalized());
  }
  texels.colour = Image8(1, 1, 3);
  const Edge edge = out.mean_slope.isZero() ? map.edge() : Edge::clamp;
  out.surface =
      std::make_shared<const Surface>(std::move(texels), moved_up(map.placement(), top), range, edge);
  return out;
}

}  // namespace intaglio::surface
