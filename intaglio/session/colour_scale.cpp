#include "intaglio/session/colour_scale.h"

#include <algorithm>
#include <cmath>

namespace intaglio::session {

namespace {

using Linear = std::array<double, 3>;

// Also takes not-a-number to 0.
double clamped(double t) {
  return t > 0 ? std::min(t, 1.0) : 0.0;
}

std::uint8_t byte(double fraction) {
  return static_cast<std::uint8_t>(std::lround(255 * clamped(fraction)));
}

}  // namespace

Rgb magma(double t) {
  static constexpr std::array<Linear, 7> coefficients = {{
      {-0.002136485053939582, -0.000749655052795221, -0.005386127855323933},
      {0.2516605407371642, 0.6775232436837668, 2.494026599312351},
      {8.353717279216625, -3.577719514958484, 0.3144679030132573},
      {-27.66873308576866, 14.26473078096533, -13.64921318813922},
      {52.17613981234068, -27.94360607168351, 12.94416944238394},
      {-50.76852536473588, 29.04658282127291, 4.23415299384598},
      {18.65570506591883, -11.48977351997711, -5.601961508734096},
  }};
  t = clamped(t);
  Rgb colour{};
  for (std::size_t c = 0; c < 3; ++c) {
    double value = 0;
    for (auto k = coefficients.rbegin(); k != coefficients.rend(); ++k) value = value * t + (*k)[c];
    colour[c] = byte(value);
  }
  return colour;
}

Rgb stone(double t) {
  static constexpr Linear low = {0.18, 0.15, 0.13}, high = {0.58, 0.54, 0.49};
  t = clamped(t);
  Rgb colour{};
  for (std::size_t c = 0; c < 3; ++c) colour[c] = byte(low[c] + t * (high[c] - low[c]));
  return colour;
}

double luminance(const Rgb& colour) {
  static constexpr Linear weight = {0.2126, 0.7152, 0.0722};
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double s = colour[c] / 255.0;
    sum += weight[c] * (s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
  }
  return sum;
}

}  // namespace intaglio::session
