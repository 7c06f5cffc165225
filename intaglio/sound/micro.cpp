#include "intaglio/sound/micro.h"

#include <cassert>
#include <cmath>
#include <complex>
#include <numbers>

#include "intaglio/core/elementary.h"
#include "intaglio/core/fourier.h"
#include "intaglio/core/random.h"

namespace intaglio::sound {

namespace {

struct TablePlace {
  std::size_t index;
  double fraction;
};

TablePlace place(double distance, double spacing) {
  const double point = distance / spacing;
  const double whole = std::floor(point);
  const double periods = std::floor(whole / MicroNoise::table_size);
  return {static_cast<std::size_t>(whole - periods * MicroNoise::table_size), point - whole};
}

}  // namespace

MicroNoise::MicroNoise(const MicroRoughness& roughness, std::uint64_t seed)
    : spacing_(roughness.correlation_length / points_per_correlation) {
  assert(roughness.correlation_length > 0);
  Random random(seed);
  std::vector<std::complex<double>> spectrum(table_size);
  for (std::size_t k = 1; k < table_size / 2; ++k) {
    const double wavenumber = 2 * std::numbers::pi * static_cast<double>(k) / (table_size * spacing_);
    const double relative = std::max(wavenumber * roughness.correlation_length, 1.0);
    const double magnitude = elementary::pow(relative, 0.5 * roughness.spectral_slope);
    const auto [sine, cosine] = elementary::sin_cos(2 * std::numbers::pi * random.uniform());
    spectrum[k] = {magnitude * cosine, magnitude * sine};
    spectrum[table_size - k] = std::conj(spectrum[k]);
  }
  std::vector<std::complex<double>> noise(table_size);
  Fourier<double>(table_size, true)(noise.data(), spectrum.data());
  double power = 0;
  for (const auto& x : noise) power += x.real() * x.real() / table_size;
  double sum = 0;
  for (const auto& x : noise) table_.push_back(static_cast<float>(x.real() / std::sqrt(power)));
  for (std::size_t k = 0; k < table_size; ++k) {
    integral_.push_back(sum);
    sum += 0.5 * (double(table_[k]) + double(table_[(k + 1) % table_size]));
  }
}

double MicroNoise::sample(double distance) const {
  const auto [index, fraction] = place(distance, spacing_);
  const double here = table_[index], next = table_[(index + 1) % table_size];
  return here + fraction * (next - here);
}

// The mean of a period is zero but for rounding, so whole periods add nothing.
double MicroNoise::integral(double distance) const {
  const auto [index, fraction] = place(distance, spacing_);
  const double here = table_[index], next = table_[(index + 1) % table_size];
  return integral_[index] + fraction * (here + 0.5 * fraction * (next - here));
}

double MicroNoise::mean(double from, double to) const {
  const double points = (to - from) / spacing_;
  // Over a hundredth of a table spacing the noise is a straight line, and the difference of integrals mostly
  // rounding.
  if (std::abs(points) < 0.01) return sample(0.5 * (from + to));
  return (integral(to) - integral(from)) / points;
}

double micro_level(const MicroRoughness& roughness, double level) {
  return level * roughness.rms_height / roughness.correlation_length;
}

}  // namespace intaglio::sound
