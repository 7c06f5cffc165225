// Micro-level sound: fractal noise for the roughness that no texture shows (§1.2.5.1).
//
// The noise is a function of the distance travelled, so its pitch follows the speed by itself; its level is
// proportional to the normal force. A table of one period, of unit rms and zero mean, is made once: the power
// spectral density is flat up to the wavenumber 1 / correlation_length (rad/m) and falls with the material's
// spectral slope above it. Immutable, any thread, no allocation in a sample. Source: van den Doel, Kry, Pai,
// "FoleyAutomatic", 2001; Ren, Yeh, Lin, 2010.
#pragma once

#include <cstdint>
#include <vector>

#include "intaglio/core/material.h"

namespace intaglio::sound {

class MicroNoise {
 public:
  static constexpr int table_size = 1 << 15;
  static constexpr double points_per_correlation = 8;

  MicroNoise(const MicroRoughness& roughness, std::uint64_t seed);

  // Distance between table points, and the distance after which the noise repeats (4,096 correlation
  // lengths), m.
  double spacing() const { return spacing_; }
  double period() const { return spacing_ * table_size; }

  // The noise at `distance` (m, any sign), linear between table points.
  double sample(double distance) const;
  // Its mean over the way from `from` to `to`: what a sample of audio is given. However long the way, nothing
  // aliases: what is shorter than it averages out. The cost does not depend on the way.
  double mean(double from, double to) const;

 private:
  double integral(double distance) const;

  double spacing_;
  std::vector<float> table_;
  std::vector<double> integral_;  // up to each table point, in units of spacing
};

// Force noise per normal force: how much of the normal force becomes noise, rms, where a surface of that
// roughness is scraped: `level` times its rms slope, rms_height / correlation_length.
double micro_level(const MicroRoughness& roughness, double level);

}  // namespace intaglio::sound
