#include "intaglio/surface/noise.h"

#include <cmath>
#include <numbers>

#include "intaglio/core/elementary.h"
#include "intaglio/core/random.h"

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

}  // namespace intaglio::surface
