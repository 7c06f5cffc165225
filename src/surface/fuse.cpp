#include "surface/fuse.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "core/fourier.h"
#include "core/portable_math.h"

namespace intaglio::surface {

void fft2(std::vector<std::complex<float>>& data, int width, int height, Transform transform) {
  using Complex = std::complex<float>;
  Fourier<float> row(width, transform == Transform::inverse), column(height, transform == Transform::inverse);
  const auto w = static_cast<std::size_t>(width);
  const auto h = static_cast<std::size_t>(height);
  std::vector<Complex> line(w), spectrum(w);
  for (std::size_t y = 0; y < h; ++y) {
    std::copy_n(data.begin() + static_cast<std::ptrdiff_t>(y * w), w, line.begin());
    row(data.data() + y * w, line.data());
  }
  // Columns, sixteen at a time: one cache line a row instead of one value.
  constexpr std::size_t batch = 16;
  std::vector<Complex> columns(h * batch), out(h);
  for (std::size_t x0 = 0; x0 < w; x0 += batch) {
    const std::size_t n = std::min(batch, w - x0);
    for (std::size_t y = 0; y < h; ++y) {
      for (std::size_t k = 0; k < n; ++k) columns[k * h + y] = data[y * w + x0 + k];
    }
    for (std::size_t k = 0; k < n; ++k) {
      column(out.data(), columns.data() + k * h);
      std::copy(out.begin(), out.end(), columns.begin() + static_cast<std::ptrdiff_t>(k * h));
    }
    for (std::size_t y = 0; y < h; ++y) {
      for (std::size_t k = 0; k < n; ++k) data[y * w + x0 + k] = columns[k * h + y];
    }
  }
}

namespace {

using Complex = std::complex<float>;
using Spectrum = std::vector<Complex>;

// The tile as it is, or continued by reflection to twice its size. Slopes across a mirror change their sign.
struct Extended {
  int width, height;
  bool mirrored;

  template <class Value>
  Spectrum fill(const Value& value) const {
    Spectrum out(std::size_t(width) * std::size_t(height));
    const int w = mirrored ? width / 2 : width;
    const int h = mirrored ? height / 2 : height;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const bool back_x = x >= w;
        const bool back_y = y >= h;
        out[std::size_t(y) * std::size_t(width) + std::size_t(x)] =
            value(back_x ? 2 * w - 1 - x : x, back_y ? 2 * h - 1 - y : y, back_x ? -1.0f : 1.0f,
                  back_y ? -1.0f : 1.0f);
      }
    }
    return out;
  }
};

// What a derivative along one axis is in the Fourier domain: i times this.
using Derivative = std::vector<double>;

Derivative derivative(int n, bool central) {
  Derivative d(static_cast<std::size_t>(n));
  for (int k = 0; k < n; ++k) {
    const int signed_k = 2 * k < n ? k : k - n;
    const double omega = 2 * std::numbers::pi * signed_k / n;
    // The Nyquist frequency of a real field has no derivative.
    d[static_cast<std::size_t>(k)] = 2 * k == n ? 0 : central ? elementary::sin(omega) : omega;
  }
  return d;
}

// One frequency of the problem: the spectra of both slopes, taken out of the transform of x + i y.
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
void each_frequency(int width, int height, const Derivative& x_axis, const Derivative& y_axis,
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
  double height, slope;  // power a texel
};

// How badly the normals are the height's derivative taken this way, in units of the noise, where the height
// is well above its own.
double misfit(int width, int height, const Derivative& x_axis, const Derivative& y_axis,
              const Spectrum& packed, const Spectrum& h0, const Noise& noise) {
  const double texels = static_cast<double>(width) * height;
  double sum = 0;
  each_frequency(width, height, x_axis, y_axis, [&](const Frequency& f) {
    const Complex h = h0[f.index];
    if (std::norm(h) < 100 * texels * noise.height) return;
    const auto [p, q] = f.slopes(packed);
    const Complex dx(0, static_cast<float>(f.dx));
    const Complex dy(0, static_cast<float>(f.dy));
    sum += (std::norm(p - dx * h) + std::norm(q - dy * h)) / (2 * noise.slope + f.power() * noise.height);
  });
  return sum;
}

double mean(const Field& field) {
  double sum = 0;
  for (const float v : field.value) sum += v;
  return field.empty() ? 0 : sum / static_cast<double>(field.value.size());
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
  return step * step / 12 * sum / static_cast<double>(std::max<std::size_t>(1, slopes.x.value.size()));
}

Fused fuse(const FuseInput& input) {
  const Field& px = input.slopes.x;
  const Field& py = input.slopes.y;
  const bool mirrored = input.edge == FuseEdge::mirrored;
  const Extended tile{mirrored ? 2 * px.width : px.width, mirrored ? 2 * px.height : px.height, mirrored};
  const bool has_height = !input.height.empty();

  Spectrum packed = tile.fill(
      [&](int x, int y, float sx, float sy) { return Complex(sx * px.at(x, y), sy * py.at(x, y)); });
  fft2(packed, tile.width, tile.height, Transform::forward);
  Spectrum h0;
  if (has_height) {
    h0 = tile.fill([&](int x, int y, float, float) { return Complex(input.height.at(x, y), 0); });
    fft2(h0, tile.width, tile.height, Transform::forward);
  }
  Fused out;
  out.mean_slope_x = mean(px);
  out.mean_slope_y = mean(py);
  Derivative x_axis = derivative(tile.width, false);
  Derivative y_axis = derivative(tile.height, false);
  if (has_height) {
    const Noise noise{std::max(1e-12, input.height_step * input.height_step / 12),
                      slope_noise(input.slopes, std::max(1e-6, input.normal_step))};
    out.lambda = noise.slope / noise.height;
    // Normals baked from finer geometry have the exact derivative; those made from the height map itself,
    // central differences. Take what fits.
    const Derivative x_central = derivative(tile.width, true);
    const Derivative y_central = derivative(tile.height, true);
    const auto cost = [&](const Derivative& x, const Derivative& y) {
      return misfit(tile.width, tile.height, x, y, packed, h0, noise);
    };
    if (cost(x_central, y_central) < cost(x_axis, y_axis)) {
      x_axis = x_central;
      y_axis = y_central;
    }
  }

  double all = 0;
  double rotational = 0;
  Spectrum solved(packed.size());
  Spectrum slopes(packed.size());
  each_frequency(tile.width, tile.height, x_axis, y_axis, [&](const Frequency& f) {
    const auto [p, q] = f.slopes(packed);
    const double power = f.power();
    const auto dx = static_cast<float>(f.dx);
    const auto dy = static_cast<float>(f.dy);
    Complex numerator = Complex(0, -dx) * p + Complex(0, -dy) * q;
    if (power > 0) {
      all += std::norm(p) + std::norm(q);
      rotational += std::norm(dx * q - dy * p) / power;
    }
    if (has_height) numerator += static_cast<float>(out.lambda) * h0[f.index];
    const double denominator = power + out.lambda;
    const Complex h = denominator > 1e-12 ? numerator / static_cast<float>(denominator) : Complex(0, 0);
    solved[f.index] = h;
    // Both slopes in one inverse transform, packed as they came.
    slopes[f.index] = Complex(0, dx) * h + Complex(0, 1) * (Complex(0, dy) * h);
  });
  out.curl = all > 0 ? std::sqrt(rotational / all) : 0;
  fft2(solved, tile.width, tile.height, Transform::inverse);
  fft2(slopes, tile.width, tile.height, Transform::inverse);
  out.height = Field(px.width, px.height);
  out.slopes = {Field(px.width, px.height), Field(px.width, px.height)};
  for (int y = 0; y < px.height; ++y) {
    for (int x = 0; x < px.width; ++x) {
      const std::size_t from = std::size_t(y) * std::size_t(tile.width) + std::size_t(x);
      out.height.at(x, y) = solved[from].real();
      out.slopes.x.at(x, y) = slopes[from].real();
      out.slopes.y.at(x, y) = slopes[from].imag();
    }
  }
  return out;
}

namespace {

constexpr double least_mean_slope = 1e-3;

// Height differences from texel to texel, metres, and their mean.
struct Differences {
  Slopes slopes;
  Vec2 mean = Vec2::Zero();
};

Differences differences(const Surface& map) {
  const int w = map.width(), h = map.height();
  const std::vector<float> normals = map.normal_texture();
  Differences out{{Field(w, h), Field(w, h)}, Vec2::Zero()};
  for (std::size_t k = 0; k < out.slopes.x.value.size(); ++k) {
    const Vec2 slope = slope_of(Vec3(normals[3 * k], normals[3 * k + 1], normals[3 * k + 2]));
    const Vec2 d(slope.x() * map.texel_u(), slope.y() * map.texel_v());
    out.slopes.x.value[k] = static_cast<float>(d.x());
    out.slopes.y.value[k] = static_cast<float>(d.y());
    out.mean += d;
  }
  out.mean /= static_cast<double>(out.slopes.x.value.size());
  for (float& d : out.slopes.x.value) d -= static_cast<float>(out.mean.x());
  for (float& d : out.slopes.y.value) d -= static_cast<float>(out.mean.y());
  return out;
}

Placement raised(const Placement& place, double by) {
  Mat3 axes;
  axes << place.t(), place.n(), -place.b();
  const Vec3 centre = place.to_world({place.size_u() / 2, place.size_v() / 2, by});
  return {centre, Quat(axes), place.size_u(), place.size_v()};
}

}  // namespace

ImpliedRelief implied_relief(const Surface& map) {
  const Differences given = differences(map);
  FuseInput input;
  input.slopes = given.slopes;
  input.edge = map.edge() == Edge::wrap ? FuseEdge::periodic : FuseEdge::mirrored;
  Field height = fuse(input).height;

  ImpliedRelief out;
  const Vec2 mean(given.mean.x() / map.texel_u(), given.mean.y() / map.texel_v());
  if (mean.norm() > least_mean_slope) out.mean_slope = mean;
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
    texels.depth.push_back(range > 0 ? static_cast<float>((top - z[k]) / range) : 0);
    texels.normal.push_back(Vec3(normals[3 * k], normals[3 * k + 1], normals[3 * k + 2]).normalized());
  }
  texels.colour = Image8(1, 1, 3);
  const Edge edge = out.mean_slope.isZero() ? map.edge() : Edge::clamp;
  out.surface = std::make_shared<const Surface>(std::move(texels), raised(map.placement(), top), range, edge);
  return out;
}

}  // namespace intaglio::surface
