#include "surface/recipes/noise.h"

#include <cmath>
#include <numbers>

#include "core/portable_math.h"

namespace intaglio::surface {

double lattice_hash(int i, int j, std::uint64_t seed) {
  const auto a = static_cast<std::uint64_t>(static_cast<std::uint32_t>(i));
  const auto b = static_cast<std::uint64_t>(static_cast<std::uint32_t>(j));
  Random random(seed ^ (a * 0x9e3779b97f4a7c15ull) ^ ((b + 1) * 0xc2b2ae3d27d4eb4full));
  random.next();
  return random.uniform();
}

double periodic_noise(double u, double v, int frequency_u, int frequency_v, std::uint64_t seed) {
  const double x = (u - std::floor(u)) * frequency_u;
  const double y = (v - std::floor(v)) * frequency_v;
  const int i = static_cast<int>(x);
  const int j = static_cast<int>(y);
  const auto gradient = [&](int di, int dj) {
    const double angle =
        2 * std::numbers::pi * lattice_hash((i + di) % frequency_u, (j + dj) % frequency_v, seed);
    const auto [sine, cosine] = elementary::sin_cos(angle);
    return cosine * (x - i - di) + sine * (y - j - dj);
  };
  const auto fade = [](double t) { return t * t * t * (t * (t * 6 - 15) + 10); };
  const double s = fade(x - i);
  const double t = fade(y - j);
  const double low = gradient(0, 0) + s * (gradient(1, 0) - gradient(0, 0));
  const double high = gradient(0, 1) + s * (gradient(1, 1) - gradient(0, 1));
  return std::numbers::sqrt2 * (low + t * (high - low));
}

double periodic_fractal(double u, double v, int frequency, int octaves, double gain, std::uint64_t seed) {
  double sum = 0;
  double level = 1;
  double total = 0;
  for (int o = 0; o < octaves; ++o) {
    sum += level * periodic_noise(u, v, frequency << o, frequency << o, seed + static_cast<std::uint64_t>(o));
    total += level;
    level *= gain;
  }
  return sum / total;
}

Fractal::Fractal(int frequency_u, int frequency_v, int octaves, double gain, std::uint64_t seed) {
  double level = 1;
  for (int o = 0; o < octaves; ++o) {
    Octave octave{frequency_u << o, frequency_v << o, level, {}};
    octave.gradients.reserve(std::size_t(octave.columns) * std::size_t(octave.rows));
    for (int j = 0; j < octave.rows; ++j) {
      for (int i = 0; i < octave.columns; ++i) {
        const double angle = 2 * std::numbers::pi * lattice_hash(i, j, seed + static_cast<std::uint64_t>(o));
        octave.gradients.push_back({elementary::cos(angle), elementary::sin(angle)});
      }
    }
    octaves_.push_back(std::move(octave));
    total_ += level;
    level *= gain;
  }
}

double Fractal::noise(const Octave& octave, double u, double v) {
  const double x = (u - std::floor(u)) * octave.columns;
  const double y = (v - std::floor(v)) * octave.rows;
  const int i = static_cast<int>(x);
  const int j = static_cast<int>(y);
  // u - floor(u) of a tiny negative u rounds to 1.
  const int i0 = i < octave.columns ? i : 0, i1 = i + 1 < octave.columns ? i + 1 : 0;
  const int j0 = j < octave.rows ? j : 0, j1 = j + 1 < octave.rows ? j + 1 : 0;
  const double fx = x - i;
  const double fy = y - j;
  const auto corner = [&](int column, int row, double dx, double dy) {
    const Gradient& g =
        octave.gradients[std::size_t(row) * std::size_t(octave.columns) + std::size_t(column)];
    return g.x * dx + g.y * dy;
  };
  const auto fade = [](double t) { return t * t * t * (t * (t * 6 - 15) + 10); };
  const double s = fade(fx);
  const double t = fade(fy);
  const double low0 = corner(i0, j0, fx, fy);
  const double high0 = corner(i0, j1, fx, fy - 1);
  const double low = low0 + s * (corner(i1, j0, fx - 1, fy) - low0);
  const double high = high0 + s * (corner(i1, j1, fx - 1, fy - 1) - high0);
  return std::numbers::sqrt2 * (low + t * (high - low));
}

double Fractal::operator()(double u, double v) const {
  double sum = 0;
  for (const Octave& octave : octaves_) sum += octave.level * noise(octave, u, v);
  return sum / total_;
}

}  // namespace intaglio::surface
