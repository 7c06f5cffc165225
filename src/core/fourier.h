// Discrete Fourier transforms of any length, of float or double, with bits that are the same everywhere:
// Eigen's butterflies, whose roots of unity come from core/portable_math.h instead of libm.
//
// Not for real time. One object is one length and direction; not thread-safe.
#pragma once

#include "intaglio/vec.h"
//
#include <complex>
#include <cstdint>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "core/portable_math.h"

namespace intaglio {

template <class Scalar>
class Fourier {
 public:
  using Complex = std::complex<Scalar>;

  // The inverse divides by the length.
  Fourier(int length, bool inverse)
      : length_(length), scale_(inverse ? static_cast<Scalar>(1.0 / length) : 1) {
    plan_.m_inverse = inverse;
    plan_.factorize(length);
    for (int k = 0; k < length; ++k) plan_.m_twiddles.push_back(root(k));
  }

  // `out` must not be `in`.
  void operator()(Complex* out, const Complex* in) {
    // Eigen's butterflies know no length of one.
    if (length_ == 1) return static_cast<void>(*out = *in);
    plan_.work(0, out, in, 1, 1);
    if (!plan_.m_inverse) return;
    for (int k = 0; k < length_; ++k) out[k] *= scale_;
  }

 private:
  // e^(-+ 2 pi i k / length); exact at quarter turns.
  Complex root(int k) const {
    const auto quarter = 4 * static_cast<std::int64_t>(k) / length_;
    const auto rest = static_cast<double>(4 * static_cast<std::int64_t>(k) - quarter * length_);
    auto [sine, cosine] = elementary::sin_cos(0.5 * std::numbers::pi * (rest / length_));
    for (int q = 0; q < quarter; ++q) {
      const double turned = cosine;
      cosine = -sine;
      sine = turned;
    }
    return {static_cast<Scalar>(cosine), static_cast<Scalar>(plan_.m_inverse ? sine : -sine)};
  }

  int length_;
  Scalar scale_;
  Eigen::internal::kiss_cpx_fft<Scalar> plan_;
};

}  // namespace intaglio
