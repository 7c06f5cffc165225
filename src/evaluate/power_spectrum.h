// The power of a trace by frequency, as the spectral distance and the vibration metrics need it.
//
// Not for real time; one object is one length, not thread-safe. Bit-identical on x86-64.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/fourier.h"

namespace intaglio::evaluate {

// The least power of two that is not less than `count`.
std::size_t power_of_two_from(std::size_t count);

class PowerSpectrum {
 public:
  // `length` is a power of two, at least 2.
  explicit PowerSpectrum(std::size_t length);

  // Sum of squares of `values`, which continue in zeros up to the length, by frequency: element k is what
  // belongs to k / length of the sample rate, both signs together, k = 0 to length / 2. The elements add up
  // to the sum of squares (Parseval). Valid until the next call.
  std::span<const double> operator()(std::span<const double> values);

 private:
  using Complex = Fourier<double>::Complex;
  Fourier<double> transform_;
  std::vector<Complex> in_, out_;
  std::vector<double> power_;
};

}  // namespace intaglio::evaluate
