// Seamless gradient noise (Perlin 2002's quintic fade, hashed gradients), for built-in materials.
#pragma once

#include <cstdint>
#include <vector>

namespace intaglio::surface {

// Noise in about -1..1 at (u, v) in 0..1, repeating with period 1, with `frequency` lattice cells a side.
double periodic_noise(double u, double v, int frequency_u, int frequency_v, std::uint64_t seed);

// Sum of `octaves` noises, each of twice the frequency and `gain` times the level of the last; about -1..1.
double periodic_fractal(double u, double v, int frequency, int octaves, double gain, std::uint64_t seed);

// A number in 0..1 that depends on (i, j, seed) only.
double lattice_hash(int i, int j, std::uint64_t seed);

// periodic_fractal of noise.h with its gradients kept: the same values, ten times as fast. Frequencies may
// differ along u and v.

class Fractal {
 public:
  Fractal(int frequency_u, int frequency_v, int octaves, double gain, std::uint64_t seed);

  // About -1..1, with period 1 in u and v.
  double operator()(double u, double v) const;

 private:
  struct Gradient {
    double x, y;
  };
  struct Octave {
    int columns, rows;
    double level;
    std::vector<Gradient> gradients;
  };

  static double noise(const Octave& octave, double u, double v);

  std::vector<Octave> octaves_;
  double total_ = 0;
};

}  // namespace intaglio::surface
