// Elementary functions and random numbers with bit-identical results on every processor and compiler.
//
// A C library's are not: glibc chooses at run time between code with and without fused multiply-add, and a
// compiler may evaluate calls with constant arguments with a different library. Whatever enters an event, a
// force or a sample must come from here (docs/determinism.md); drawing, printing and timing need not.
//
// Only + - * / and square roots of doubles, which IEEE 754 rounds in one way, in a fixed order; needs
// -ffp-contract=off. Errors are in units in the last place, the largest found by
// tests/core/test_portable_math.cpp. NaN gives NaN, always with the same bits. Real-time: no allocation.
// About 10 ns for a sine, exponential or logarithm, 20 for an arctangent, 50 for a power, 100 for a cube root
// (libm: 14, 6, 11, 21, 14, 13).
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

// x to the power of y for x >= 0 (NaN for x < 0). Below 1.2 ulp for results of 1e-12 to 1e12; the error grows
// with the result's logarithm.
double pow(double x, double y);

// Below 1 ulp, any sign.
double cbrt(double x);

// In (-pi, pi], with the signed zeros of std::atan2. Below 2 ulp for arguments within 1e-290..1e290.
double atan2(double y, double x);

// Below 2 ulp for -1 <= x <= 1.
double acos(double x);

// Absolute error 3e-16; the relative error is large near 0.
double tanh(double x);

// sqrt(x^2 + y^2), below 2 ulp; the squares must not overflow or underflow.
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
  double uniform() { return double(next() >> 11) * 0x1.0p-53; }
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
