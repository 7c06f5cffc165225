// Perceptually uniform colour scales: equal steps of a value are equal steps of lightness, also in grey and
// for colour-blind eyes.
#pragma once

#include <array>
#include <cstdint>

namespace intaglio::session {

using Rgb = std::array<std::uint8_t, 3>;  // sRGB

// The scale "magma" of Smith and van der Walt (matplotlib, 2015), black to pale yellow, for t in 0..1
// (clamped; not-a-number is 0). Within 3/255 of their table: sixth-degree fits by M. Zucker (2019, public
// domain).
Rgb magma(double t);

// Stone: dark brown joint to grey-brown face, for t in 0..1 (clamped). Dark enough that bright lines stand
// out on it.
Rgb stone(double t);

// WCAG relative luminance, 0..1.
double luminance(const Rgb& colour);

}  // namespace intaglio::session
