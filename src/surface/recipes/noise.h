// Seamless random fields for built-in materials: fractal gradient noise, and hashes of lattice points.
#pragma once

#include <cstdint>
#include <vector>

namespace intaglio::surface {

// A number in 0..1 that depends on (i, j, seed) only.
double lattice_hash(int i, int j, std::uint64_t seed);

// A sum of gradient noises (Perlin 2002's quintic fade, hashed gradients), each of twice the frequency and
// `gain` times the level of the last. Gradients are precomputed, which is about ten times faster than
// hashing.
class Fractal {
 public:
  // `frequency`: lattice cells per side.
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
