#include "evaluate/third_octaves.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/portable_math.h"

namespace intaglio::evaluate {
namespace {

using Complex = std::complex<double>;
constexpr std::size_t bands = third_octave_count;
constexpr std::size_t sections = 3;

// One factor gain (1 - z^-2) / (1 + a1 z^-1 + a2 z^-2).
struct BandSection {
  double gain, a1, a2;
};
using BandFilter = std::array<BandSection, sections>;

Complex square_root(Complex z) {
  const double modulus = elementary::hypot(z.real(), z.imag());
  const double real = std::sqrt(std::max(0.0, (modulus + z.real()) / 2));
  const double imaginary = std::sqrt(std::max(0.0, (modulus - z.real()) / 2));
  return {real, z.imag() < 0 ? -imaginary : imaginary};
}

// Not by the compiler's own division, whose rounding differs from library to library.
Complex quotient(Complex above, Complex below) {
  return above * std::conj(below) / std::norm(below);
}

// The factor with the pole pair of the analogue pole `p`, with unit gain at `centre` (radians a sample).
BandSection section_of(Complex p, double centre) {
  const Complex pole = quotient(1.0 + p, 1.0 - p);
  BandSection section{1, -2 * pole.real(), std::norm(pole)};
  const auto [sine, cosine] = elementary::sin_cos(centre);
  const Complex delay(cosine, -sine), delay2 = delay * delay;
  const Complex above = 1.0 - delay2, below = 1.0 + section.a1 * delay + section.a2 * delay2;
  section.gain =
      elementary::hypot(below.real(), below.imag()) / elementary::hypot(above.real(), above.imag());
  return section;
}

// A Chebyshev band-pass of sixth order that lets a hundredth of the power through at `low` and `high` Hz. Its
// prototype has 1 / (1 + e^2 C3(x)^2) with x = 4.5 there, and C3(4.5) = 351.
BandFilter band_filter(double low, double high, double rate) {
  constexpr double x = 4.5, c3 = 4 * x * x * x - 3 * x;
  const auto warped = [&](double frequency) {
    const auto [sine, cosine] = elementary::sin_cos(std::numbers::pi * frequency / rate);
    return sine / cosine;
  };
  const double width = (warped(high) - warped(low)) / x, square = warped(high) * warped(low);
  const double centre = 2 * std::numbers::pi * std::sqrt(low * high) / rate;
  const auto pole = [&](Complex prototype, double sign) {
    const Complex half = prototype * (width / 2);
    return half + sign * square_root(half * half - square);
  };
  // The prototype's poles lie on an ellipse with half axes sinh and cosh of asinh(1 / e) / 3.
  const double ratio = c3 / std::sqrt(99.0);
  const double root = elementary::cbrt(ratio + std::sqrt(ratio * ratio + 1));
  const double sinh = (root - 1 / root) / 2, cosh = (root + 1 / root) / 2;
  const Complex turned(-sinh / 2, cosh * std::numbers::sqrt3 / 2);
  return {section_of(pole(-sinh, 1), centre), section_of(pole(turned, 1), centre),
          section_of(pole(turned, -1), centre)};
}

// All bands side by side, so that a processor's vector units work on several.
class BandBank {
 public:
  explicit BandBank(double rate) {
    const double step = elementary::pow(10, 0.1);
    for (std::size_t b = 0; b < bands; ++b) {
      const double f = third_octave_centre(int(b));
      BandFilter filter{};
      if (f * step < 0.45 * rate) filter = band_filter(f / step, f * step, rate);
      for (std::size_t s = 0; s < sections; ++s) {
        gain_[s][b] = filter[s].gain;
        a1_[s][b] = filter[s].a1;
        a2_[s][b] = filter[s].a2;
      }
    }
  }

  // The squares of the bands' next samples.
  const std::array<double, bands>& squares(double sample) {
    output_.fill(sample);
    for (std::size_t s = 0; s < sections; ++s)
      for (std::size_t b = 0; b < bands; ++b) {
        // Transposed direct form II, whose first coefficient of the numerator is 1, second 0, third -1.
        const double in = gain_[s][b] * output_[b];
        const double out = in + first_[s][b];
        first_[s][b] = second_[s][b] - a1_[s][b] * out;
        second_[s][b] = -in - a2_[s][b] * out;
        output_[b] = out;
      }
    for (double& output : output_) output *= output;
    return output_;
  }

 private:
  using Row = std::array<double, bands>;
  std::array<Row, sections> gain_{}, a1_{}, a2_{}, first_{}, second_{};
  Row output_{};
};

}  // namespace

double third_octave_centre(int band) {
  assert(band >= 0 && band < third_octave_count);
  return 1000 * elementary::pow(10, (band - 16) / 10.0);
}

ThirdOctaves third_octave_powers(std::span<const float> sound, double rate, double skip) {
  assert(rate > 0 && skip >= 0);
  BandBank bank(rate);
  ThirdOctaves powers{};
  const auto first = std::min(std::size_t(skip * rate), sound.size());
  for (std::size_t n = 0; n < sound.size(); ++n) {
    const auto& squares = bank.squares(double(sound[n]));
    if (n < first) continue;
    for (std::size_t b = 0; b < bands; ++b) powers[b] += squares[b];
  }
  for (double& power : powers) power /= double(std::max<std::size_t>(sound.size() - first, 1));
  return powers;
}

std::vector<ThirdOctaves> third_octave_envelopes(std::span<const float> sound, double rate,
                                                 double per_second) {
  assert(rate > 0 && per_second > 0);
  BandBank bank(rate);
  ThirdOctaves keep{};
  for (std::size_t b = 0; b < bands; ++b)
    keep[b] = elementary::exp(-1.5 * std::min(third_octave_centre(int(b)), 1000.0) / rate);
  std::array<ThirdOctaves, 3> smooth{};
  std::vector<ThirdOctaves> envelopes;
  for (std::size_t n = 0; n < sound.size(); ++n) {
    const auto& squares = bank.squares(double(sound[n]));
    for (std::size_t b = 0; b < bands; ++b) {
      double value = squares[b];
      for (ThirdOctaves& stage : smooth) {
        value += keep[b] * (stage[b] - value);
        stage[b] = value;
      }
    }
    if (double(n) >= double(envelopes.size()) * rate / per_second) envelopes.push_back(smooth[2]);
  }
  return envelopes;
}

ThirdOctaves third_octave_levels(const ThirdOctaves& powers) {
  constexpr double reference = 4e-10, least = 1e-12;
  ThirdOctaves levels{};
  for (std::size_t b = 0; b < bands; ++b)
    levels[b] = 10 * (elementary::log((powers[b] + least) / reference) / std::numbers::ln10);
  return levels;
}

}  // namespace intaglio::evaluate
