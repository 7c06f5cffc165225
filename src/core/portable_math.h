// Sines, exponentials and their like whose bits are the same on every processor and with every compiler.
//
// Those of a C library are not: glibc chooses at run time between code with and without fused multiply-add,
// and a compiler may fold a call of known arguments by another library. What enters an event, a force or a
// sample must come from here (docs/determinism.md); what is only drawn, printed or measured need not.
//
// Only + - * / and square roots of doubles, which IEEE 754 rounds in one way, in one order; needs
// -ffp-contract=off. Errors are in units in the last place, the largest of tests/core/test_elementary.cpp.
// Not-a-number gives not-a-number, always of the same bits. Real-time: no allocation. Some 10 ns a sine,
// exponential or logarithm, 20 an arctangent, 50 a power, 100 a cube root (libm: 14, 6, 11, 21, 14, 13).
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace intaglio::elementary {

struct SinCos {
  double sin, cos;
};

// Below 1.2 ulp for |x| < 1.6e6 rad; beyond it the argument is first taken modulo the double nearest to 2 pi.
SinCos sin_cos(double x);
double sin(double x);
double cos(double x);

// Below 1 ulp where the result is normal; 0 below -745.2, infinity above 709.8.
double exp(double x);

// Below 1 ulp for x > 0; -infinity at 0.
double log(double x);

// x to the power of y for x >= 0 (not-a-number below). Below 1.2 ulp for results of 1e-12 to 1e12; the error
// grows with the result's logarithm.
double pow(double x, double y);

// Below 1 ulp, of any sign.
double cbrt(double x);

// (-pi, pi], signs of zeros as std::atan2 takes them. Below 2 ulp for arguments within 1e-290..1e290.
double atan2(double y, double x);

// Below 2 ulp for -1 <= x <= 1.
double acos(double x);

// Within 3e-16 (absolutely: no good for the relative size of what is tiny).
double tanh(double x);

// The root of the sum of squares, for lengths: below 2 ulp, but squares must neither overflow nor vanish.
inline double hypot(double x, double y) {
  return std::sqrt(x * x + y * y);
}

}  // namespace intaglio::elementary

namespace intaglio {

// SplitMix64: a small seeded generator whose stream is the same on every platform (the distributions of
// <random> are not). Source: Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014.

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  // Uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  // Standard normal, by Box and Muller.
  double normal() {
    const double radius = std::sqrt(-2.0 * elementary::log(1.0 - uniform()));
    return radius * elementary::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  std::uint64_t state_;
};

}  // namespace intaglio
