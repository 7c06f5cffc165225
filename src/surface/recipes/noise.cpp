#include "surface/recipes/noise.h"

#include <cmath>
#include <numbers>

#include "core/portable_math.h"

namespace intaglio::surface {

double lattice_hash(int i, int j, std::uint64_t seed) {
  const auto a = std::uint64_t(std::uint32_t(i));
  const auto b = std::uint64_t(std::uint32_t(j));
  Random random(seed ^ (a * 0x9e3779b97f4a7c15ull) ^ ((b + 1) * 0xc2b2ae3d27d4eb4full));
  random.next();
  return random.uniform();
}

Fractal::Fractal(int frequency_u, int frequency_v, int octaves, double gain, std::uint64_t seed) {
  double level = 1;
  for (int o = 0; o < octaves; ++o) {
    Octave octave{frequency_u << o, frequency_v << o, level, {}};
    octave.gradients.reserve(std::size_t(octave.columns) * std::size_t(octave.rows));
    for (int j = 0; j < octave.rows; ++j) {
      for (int i = 0; i < octave.columns; ++i) {
        const double angle = 2 * std::numbers::pi * lattice_hash(i, j, seed + std::uint64_t(o));
        octave.gradients.push_back({elementary::cos(angle), elementary::sin(angle)});
      }
    }
    octaves_.push_back(std::move(octave));
    total_ += level;
    level *= gain;
  }
}

double Fractal::noise(const Octave& octave, double u, double v) {
  const double x = (u - std::floor(u)) * octave.columns, y = (v - std::floor(v)) * octave.rows;
  const int i = int(x), j = int(y);
  // u - floor(u) of a tiny negative u rounds to 1.
  const int i0 = i < octave.columns ? i : 0, i1 = i + 1 < octave.columns ? i + 1 : 0;
  const int j0 = j < octave.rows ? j : 0, j1 = j + 1 < octave.rows ? j + 1 : 0;
  const double fx = x - i, fy = y - j;
  const auto corner = [&](int column, int row, double dx, double dy) {
    const Gradient& g =
        octave.gradients[std::size_t(row) * std::size_t(octave.columns) + std::size_t(column)];
    return g.x * dx + g.y * dy;
  };
  const auto fade = [](double t) { return t * t * t * (t * (t * 6 - 15) + 10); };
  const double s = fade(fx), t = fade(fy);
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
