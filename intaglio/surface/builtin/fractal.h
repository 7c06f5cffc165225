// periodic_fractal of noise.h with its gradients kept: the same values, ten times as fast. Frequencies may
// differ along u and v.
#pragma once

#include <cstdint>
#include <vector>

namespace intaglio::surface {

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
